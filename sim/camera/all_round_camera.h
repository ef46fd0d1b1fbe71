// A camera that sees all round: one equirectangular picture.
//
// Columns are azimuths, from behind over left, ahead and right to behind again; the middle of the
// picture looks along the mount frame's x. Rows are elevations, from `elevation_upper` down. A
// pixel is 360 degrees / width high and wide; pixel (c, r) has its middle at
//   azimuth to the right = ((c + 0.5) / width - 0.5) 360 degrees
//   elevation            = upper - (r + 0.5) 360 degrees / width
//
// There are two ways to render it, chosen by one key:
//   rays   each pixel's ray is cast where the pixel looks (a lens of the model equirectangular):
//          no seam, no interpolation, all of the sphere
//   views  three or more cameras with plain lenses, all in one point, each for its share of the
//          round, joined by interpolating their numbers: their pixels are wide in their middle and
//          narrow at their edges, their noise is correlated, and the joined picture is black above
//          and below theirs. Three are those of Wolf, Groll, Hemer, Berns, "Evolution of robotic
//          simulators", SIMULTECH 2020.
// A picture of views shows each of them with its own noise, fixed pattern, dirt and fall-off of the
// light. Cost of both ways, and the error of one relative to the other: `rigwire bench camera`.
//
// A grey sensor gives Mono8, 10, 12; one behind a Bayer mosaic RGB8, its colours interpolated from
// the nearest two or four pixels of theirs, without white balance.
//
// Not modelled: heads at a distance from each other, with parallax and blending at their seams.
//
// Defaults: the paper's three views of 120 degrees, with 640 pixels each, joined to about as many
// as they have in their middle.
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <string_view>

#include "sim/camera/camera_sensor.h"

namespace rigwire::sim {

enum class AllRoundMethod : std::uint8_t { rays, views };

struct AllRoundCameraParameters {
  static constexpr fields::Named kNamed{"all_round", "One equirectangular image, 360 degrees."};

  AllRoundMethod method = AllRoundMethod::rays;
  int width_px = 1024;  ///< Columns of the joined picture, 360 degrees.
  int height_px = 256;
  double elevation_upper_rad = 0.25 * std::numbers::pi;  ///< Upper edge of the first row.
  int views = 3;
  /// `rays`: the sensor's size and the lens's geometry follow from the picture. `views`: optics of
  /// each view; its lens has no distortion, and the focal length follows from its share of the
  /// circle.
  CameraParameters camera = optics();

 private:
  [[nodiscard]] static CameraParameters optics();
};
void visit(fields::Visitor& v, AllRoundCameraParameters& p);
/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const AllRoundCameraParameters& parameters);

/// Throws std::invalid_argument as validate() and CameraRenderer do.
[[nodiscard]] std::unique_ptr<CameraSensor> make_all_round_camera(
    const AllRoundCameraParameters& parameters, std::uint64_t seed, std::string_view name);

}  // namespace rigwire::sim
