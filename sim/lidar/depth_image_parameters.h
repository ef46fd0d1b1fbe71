// How a depth image becomes lidar ranges: every choice of the pipeline, from the paper's to the
// exact one.
//
// After Wolf, Groll, Hemer and Berns, "Evolution of Robotic Simulators: Using UE 4 to Enable
// Real-World Quality Testing of Complex Autonomous Robots in Unstructured Environments", SIMULTECH
// 2020, Eq. 4 and Algorithm 2: virtual cameras with frusta of at most 170 degrees render depth
// images of which all rows but the lasers' are skipped.
#pragma once

#include "fields/rules.h"

namespace rigwire::sim {

/// What the depth buffer keeps of a planar depth z between near plane n and far plane f.
enum class DepthFormat {
  reversed_float,  ///< n / z as a float: as fine as the float of the range.
  fixed_24,  ///< (1/n - 1/z) / (1/n - 1/f) in 24 bits: steps of z^2 / (2^24 n), 6 mm at 100 m.
};

/// Image row of a laser at azimuth p off the optical axis, where the image's column is x = f tan p
/// from the middle and the laser's row on the axis is a.
enum class RowRule {
  straight,              ///< a everywhere.
  hyperbola_half_width,  ///< a sqrt(1 + (x / b)^2) with b = W / 2, Eq. 4 as printed.
  hyperbola_focal,       ///< a sqrt(1 + (x / f)^2), a pinhole's exact image of the laser's cone.
};

/// Image column of an azimuth.
enum class ColumnRule {
  uniform,    ///< Columns equally wide in angle.
  resampled,  ///< f tan p.
};

/// Where a laser's row on the optical axis comes from.
enum class ElevationRule {
  pixels_per_beam,  ///< Equal steps from the lowest laser's row to the highest's, as Algorithm 2.
  sensor_table,     ///< f tan of the laser's own elevation.
};

/// How depth is read between pixel centres.
enum class DepthSampling {
  nearest,
  bilinear_depth,          ///< z of the four pixels around; makes points in mid-air at silhouettes.
  bilinear_inverse_depth,  ///< 1/z of them: exact on planes; makes the same points in mid-air.
  edge_aware,              ///< 1/z of them where they continue each other's slope, else nearest.
  tangent_plane,           ///< The plane through the nearest pixel with that pixel's normal.
};

struct DepthImageParameters {
  int cameras = 3;                 ///< Around the spin axis, each for an equal sector.
  double field_of_view_deg = 0.0;  ///< Horizontal, of each; 0: just the sector. At most 170.
  int width_px = 1024;
  int height_px = 0;  ///< 0: as many as the rows that lasers may have in the sector need.
  int images_per_revolution = 1;  ///< 1: one instant for all directions, as the paper's.
  DepthFormat depth = DepthFormat::reversed_float;
  double near_plane_m = 0.1;  ///< In planar depth.
  RowRule rows = RowRule::hyperbola_focal;
  ColumnRule columns = ColumnRule::resampled;
  ElevationRule elevations = ElevationRule::sensor_table;
  DepthSampling sampling = DepthSampling::edge_aware;
  /// Cameras look from the origin of the sensor frame, beams leave beside it. Each step brings the
  /// range nearer to the beam's own, by a factor of about offset / (range tan(grazing angle)).
  /// Needs the exact row, column and elevation rules.
  int parallax_steps = 2;
};
void visit(fields::Visitor& v, DepthImageParameters& p);

/// The pipeline as the paper prints it: three cameras, one instant, Eq. 4 with b = W / 2, pixels
/// per beam, nearest pixel. The paper does not say how columns become azimuths; here they are
/// resampled.
[[nodiscard]] DepthImageParameters as_printed();

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const DepthImageParameters& parameters);

/// Horizontal, of each camera.
[[nodiscard]] double field_of_view_rad(const DepthImageParameters& parameters);

}  // namespace rigwire::sim
