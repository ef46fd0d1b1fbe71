// The surface of the ground in a disparity picture, on slopes and uneven terrain, below whatever
// stands on it.
//
// 1. The plane that most of the ground is near. A plane is linear in disparity: d = a u + b v + c
//    (R. Labayrade et al., "Real time obstacle detection in stereovision on non flat road geometry
//    through v-disparity representation", IV 2002, with the roll in it), and a disparity's error is
//    the same all over the picture: so a plane is searched among triples of pixels there (RANSAC,
//    M. A. Fischler, R. C. Bolles, CACM 24(6), 1981), in an order that is always the same.
// 2. Heights above it, in a grid of cells seen from above.
// 3. Cells that are ground: those that no other cell proves to stand out, by lying so much lower
//    that the way up would be steeper than ground is (G. Vosselman, "Slope based filtering of laser
//    altimetry data", IAPRS 33, 2000).
// 4. A membrane through these cells, the stiffer the less certain their heights are; it spans what
//    is hidden or stands on the ground.
#pragma once

#include <optional>
#include <vector>

#include "find_rocks/stereo_picture.h"

namespace rigwire::find_rocks {

/// How the camera is mounted over level ground. Without it the plane is what most pixels are near,
/// which a heap close ahead may be, too.
struct CameraMount {
  static constexpr double kHeightTolerance = 0.3;     ///< Share of the height.
  static constexpr double kTiltTolerance_deg = 15.0;  ///< Machine and ground are tilted as well.

  double height_m = 0.0;
  double pitch_deg = 0.0;  ///< Nose down positive.
};

struct GroundSettings {
  /// Standard deviation of the camera's disparities: half the width of the interval that contains
  /// 68 % of the errors on the ground, 3 to 11 m ahead of the stereo cameras of the rigs (0.21 in
  /// the pit, 0.18 in the forest).
  double disparity_sigma_px = 0.18;
  double steepest_deg = 40.0;  ///< Ground is no steeper: loose material rests at 30 to 40.
  double farthest_m = 25.0;    ///< Along the ground; nothing beyond it is evaluated.
  double aside_m = 15.0;       ///< To either side.
  double cell_m = 0.25;
  /// The ground's plane is tilted against the picture by no more: sets walls apart.
  double tilt_limit_deg = 60.0;
  std::optional<CameraMount> mount;
};

class GroundSurface {
 public:
  /// Nothing when no ground is found in the picture.
  [[nodiscard]] static std::optional<GroundSurface> find(const StereoPicture& picture,
                                                         const GroundSettings& settings);

  /// A point in coordinates of the ground.
  struct Place {
    double ahead_m = 0.0;   ///< Along the plane, from below the camera.
    double left_m = 0.0;    ///< Across.
    double height_m = 0.0;  ///< Above the plane.
  };
  [[nodiscard]] Place place(const Point& point) const;
  /// Returns the height of the ground above its plane; empty off the grid.
  [[nodiscard]] std::optional<double> height_m(const Place& place) const;
  /// Returns the height of the camera above the plane.
  [[nodiscard]] double camera_height_m() const { return camera_height_m_; }
  /// Returns the angle of the camera's axis below the plane's direction, nose down positive.
  [[nodiscard]] double pitch_rad() const { return std::asin(-up_.z); }
  /// Returns the standard deviation of the height of a pixel at this distance ahead.
  [[nodiscard]] double height_sigma_m(double ahead_m) const;

 private:
  GroundSurface(const GroundSettings& settings, double focal_baseline);

  [[nodiscard]] bool find_plane(const StereoPicture& picture);
  [[nodiscard]] bool lay_surface(const StereoPicture& picture);
  [[nodiscard]] std::vector<float> cell_heights(const StereoPicture& picture,
                                                std::vector<float>& weights) const;
  void drop_holes(std::vector<float>& heights) const;
  [[nodiscard]] std::vector<float> lower_bound(const std::vector<float>& heights) const;
  void span_membrane(const std::vector<float>& heights, const std::vector<float>& weights);
  [[nodiscard]] std::size_t cell(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  GroundSettings settings_;
  double focal_baseline_;
  int rows_;     ///< Rows of cells, ahead.
  int columns_;  ///< From right to left.
  Point up_;     ///< Unit vectors of the plane, in C.
  Point ahead_;
  Point left_;
  double camera_height_m_ = 0.0;
  std::vector<float> surface_m_;
};

}  // namespace rigwire::find_rocks
