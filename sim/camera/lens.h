// A lens: which way each pixel looks, and where a point is seen.
//
// Frame C of a lens, as OpenCV has it: x right, y down, z along the optical axis. Pixels are
// (column, row) of the sensor, counted from 0, with the middle of a pixel at whole numbers.
//
// Models:
//   brown_conrady   x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), y' alike,
//                   of x = X/Z, y = Y/Z   (D. C. Brown, "Close-range camera calibration",
//                   Photogrammetric Engineering 37(8), 1971; the five numbers and their order are
//                   those of OpenCV's calibrateCamera)
//   kannala_brandt  r' = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta the
//                   angle from the axis   (J. Kannala, S. S. Brandt, "A generic camera model and
//                   calibration method for conventional, wide-angle, and fish-eye lenses", IEEE
//                   PAMI 28(8), 2006, with the coefficients of OpenCV's fisheye model)
//   equirectangular column by the angle to the right of the axis, row by the angle below its plane,
//                   focal length in pixels for each rad: no lens, but the picture that cameras
//                   which see all round are joined to. Up to 360 by 180 degrees.
// Directions come from the model's own inverse, by Newton's method from a bracketed start: what
// project(direction(pixel)) returns differs from `pixel` by less than 1e-9 pixels (up to 16384
// pixels a side; tested). Both models fold over where their polynomial turns; a lens whose picture
// reaches that far is refused.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "fields/rules.h"

namespace rigwire::sim {

enum class LensModel : std::uint8_t { brown_conrady, kannala_brandt, equirectangular };

struct LensParameters {
  LensModel model = LensModel::brown_conrady;
  double focal_length_m = 0.004;
  double f_number = 4.0;
  double k1 = 0.0;  ///< k1, k2, k3: brown_conrady and kannala_brandt.
  double k2 = 0.0;
  double p1 = 0.0;  ///< p1, p2: brown_conrady only.
  double p2 = 0.0;
  double k3 = 0.0;
  double k4 = 0.0;  ///< kannala_brandt only.
  /// Principal point, from the sensor's middle, in pixels right and down.
  Eigen::Vector2d principal_offset_px = Eigen::Vector2d::Zero();
  /// Farther from the axis than this the picture is black; 0: the lens fills the sensor.
  double image_circle_rad = 0.0;
  /// How much the light falls off to the edge: 1 as cos^4 of the angle from the axis, 0 not at all.
  double vignetting = 1.0;
  /// Modulation transfer at 0.25 cycles per pixel, of lens and pixel together (lens_blur.h).
  double mtf = 0.72;
};
void visit(fields::Visitor& v, LensParameters& p);
/// Those of its keys that say how much light comes through and how sharp it is, for cameras that
/// know the rest.
void visit_light(fields::Visitor& v, LensParameters& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const LensParameters& parameters);

/// Across the picture's middle, of a lens of the model brown_conrady: 120 degrees, and a margin for
/// focal lengths that were rounded.
inline constexpr double kWidestBrownConrady_rad = 2.11;

class Lens {
 public:
  /// In front of a sensor of square pixels. Throws std::invalid_argument as validate() does; when
  /// the model folds over within the picture; when a brown_conrady lens sees more than
  /// kWidestBrownConrady_rad; when a kannala_brandt one would see more than 180 degrees from its
  /// axis; when an equirectangular picture goes more than once round, or beyond a pole.
  Lens(const LensParameters& parameters, double pixel_pitch_m, int width_px, int height_px);

  /// Unit vector in C; nothing where the lens has no picture (beyond the image circle, or a point
  /// off the sensor that the model does not reach).
  [[nodiscard]] std::optional<Eigen::Vector3d> direction(const Eigen::Vector2d& pixel) const;
  /// Where a point or a direction in C is seen, on or off the sensor; nothing when it is not.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;

  /// Share of the light on the axis that comes to a pixel in that direction; of an equirectangular
  /// picture all of it.
  [[nodiscard]] double falloff(const Eigen::Vector3d& direction_C) const;

  [[nodiscard]] double focal_length_px() const { return focal_px_; }
  [[nodiscard]] const Eigen::Vector2d& principal_point_px() const { return centre_; }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  [[nodiscard]] const LensParameters& parameters() const { return parameters_; }

 private:
  [[nodiscard]] Eigen::Vector2d distorted(const Eigen::Vector2d& ideal) const;
  [[nodiscard]] Eigen::Matrix2d distortion_slope(const Eigen::Vector2d& ideal) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> undistorted(const Eigen::Vector2d& seen) const;
  [[nodiscard]] double image_radius(double theta_rad) const;
  [[nodiscard]] double image_radius_slope(double theta_rad) const;
  [[nodiscard]] std::optional<double> angle_at(double radius) const;
  void find_limit();
  void require_whole_picture() const;

  LensParameters parameters_;
  double focal_px_;
  Eigen::Vector2d centre_;
  int width_px_;
  int height_px_;
  double circle_rad_;  ///< Maximum visible angle from the axis.
  /// Up to where the model is monotonic, or the image circle ends: r^2 of brown_conrady, theta of
  /// kannala_brandt.
  double limit_;
  bool folds_ = false;  ///< The model turns before the image circle ends.
};

}  // namespace rigwire::sim
