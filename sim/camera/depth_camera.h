// A depth camera: time of flight of its own light, by its phase, for each pixel.
//
// Each pixel casts a lattice of rays over its area and over the exposure. What comes back of a ray
// has the strength
//   s = rho cos(a) / rho0  (r0 / r)^2  t / t0
// (rho reflectance at 905 nm and a angle of incidence of the surface, r distance, t exposure; with
// index 0 the reference of the data sheet: a surface seen straight on) and a phase by its distance;
// the pixel sees their vector sum, S = |mean s exp(i k r)|, r = arg / k. So pixels on edges float
// between front and back. Noise of r, after R. Lange, P. Seitz, "Solid-state time-of-flight range
// camera", IEEE J. Quantum Electronics 37(3), 2001, with the noise of reading out and of the light
// of day above that of its own light:
//   sigma^2 = floor^2 + (sigma0 / S)^2 (1 + L / L2  t / t0)
// grows with the square of the distance; L is the luminance of what the pixel sees by daylight, as
// CameraRenderer has it (sun, shadow, sky, air), L2 that which doubles the variance. In fog and
// dust s falls by the way there and back. Added are an error that runs through a cycle over the
// distance, as phase measurements have it (M. Lindner, A. Kolb, "Lateral and depth calibration of
// PMD-distance sensors", ISVC 2006), and the step of the coding.
//
// No range where the surface is nearer or farther than the working range, where sigma is above
// `greatest_noise` (dark, far, grazing or sunlit surfaces), or where the image saturates. Distances
// beyond the range without ambiguity, half the wave length, fold back as they do in the device.
// Confidence is 255 (1 - sigma / greatest_noise).
//
// Parts: the image, in which the sensor sees its own light and a share of the light of day; range
// along the optical axis; confidence. The lens has no distortion: what is reported of it,
// depth_geometry(), has no words for any.
//
// Defaults after the documentation of Basler blaze-101 (docs.baslerweb.com: "Fast Mode" for its
// long range: 0.3 .. 10 m, 30 m without ambiguity, accuracy +-5 mm, temporal noise below 1 mm up to
// 5.5 m; "Daylight Robustness": 12.8 W/m2 of 920 .. 970 nm on a white surface at 6 m and 250 us
// make seven times the noise): 640 x 480 pixels of 10 um, 67 degrees across. L2 is from the latter
// with 25 W/m2 of that band at 110 klx. Ours are: the floor of the noise (0.3 mm, its short range),
// the length of the cycle (a quarter of the 1.5 m of its higher frequency), how bright its own
// light is, and the sensor's figures.
//
// Left out: light that comes by several ways, the four to eight exposures of a device (a moving
// edge blurs, it does not tear), its filters, and retro-reflectors.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "sim/camera/camera_sensor.h"
#include "sim/camera/reported_geometry.h"

namespace rigwire::sim {

struct DepthCameraParameters {
  static constexpr fields::Named kNamed{"depth", "Range and its confidence, with an image."};

  CameraParameters camera = optics();
  int rays_across = 2;  ///< Rays across a pixel, and as many down, for its range.
  double nearest_m = 0.3;
  double farthest_m = 10.0;
  double unambiguous_m = 30.0;  ///< Distances beyond fold back.
  double step_m = 0.0002;       ///< Step of the coded range; codes have 16 bits.

  // Noise at the reference, in the dark.
  double noise_m = 0.001;         ///< sigma0.
  double noise_distance_m = 5.5;  ///< r0.
  double noise_reflectance = 0.9;
  Duration noise_exposure = std::chrono::milliseconds{1};  ///< t0.

  double noise_floor_m = 0.0003;
  double greatest_noise_m = 0.02;
  /// L2, cd/m2 at the exposure of the reference.
  double doubling_luminance_cd = 84.0;

  double cyclic_error_m = 0.005;  ///< Amplitude.
  double cycle_m = 0.375;

  /// For the image: luminance of the reference surface by the camera's own light, cd/m2, and the
  /// share of the daylight that passes the filter.
  double own_luminance_cd = 1.0;
  double daylight_share = 0.002;

 private:
  [[nodiscard]] static CameraParameters optics();
};
void visit(fields::Visitor& v, DepthCameraParameters& p);
/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const DepthCameraParameters& parameters);

[[nodiscard]] ReportedGeometry depth_geometry(const DepthCameraParameters& parameters);

/// Standard deviation of a range, m, at that strength and luminance of daylight.
[[nodiscard]] double range_noise_m(const DepthCameraParameters& parameters, double strength,
                                   double luminance_cd, Duration exposure);

/// Throws std::invalid_argument as validate() and CameraRenderer do.
[[nodiscard]] std::unique_ptr<CameraSensor> make_depth_camera(
    const DepthCameraParameters& parameters, std::uint64_t seed, std::string_view name);

}  // namespace rigwire::sim
