// A disparity picture, and the points that it represents.
//
// Frame C of the picture: x right, y down, z along the optical axis, metres. A pixel of disparity d
// (px) is at Z = f B / d, X = (u - u0) Z / f, Y = (v - v0) Z / f; f, u0, v0 in pixels of this
// picture, B the baseline (SFNC, Scan3dOutputMode "DisparityC").
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace rigwire::find_rocks {

/// Or a vector.
struct Point {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};
[[nodiscard]] inline double dot(const Point& a, const Point& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Point scaled(const Point& a, double factor) {
  return {a.x * factor, a.y * factor, a.z * factor};
}

struct StereoGeometry {
  double focal_px = 0.0;
  double baseline_m = 0.0;
  double principal_u_px = 0.0;
  double principal_v_px = 0.0;
  double scale_px = 1.0;                 ///< Disparity for each count of a pixel.
  double offset_px = 0.0;                ///< Disparity of a pixel that is 0.
  std::optional<std::uint16_t> invalid;  ///< Count of a pixel that has none.

  /// What Z times disparity is.
  [[nodiscard]] double focal_baseline() const { return focal_px * baseline_m; }

  /// From a camera's features, asked by their names in SFNC. Throws std::invalid_argument naming
  /// what is missing, or what cannot be.
  [[nodiscard]] static StereoGeometry read(
      const std::function<std::optional<double>(std::string_view)>& feature);
};

class StereoPicture {
 public:
  static constexpr float kNone = 0.0F;

  /// Pixels of two bytes, the least significant first, row by row without padding; disparities
  /// that are not positive are none. `confidence`: of each pixel, or empty; below
  /// `least_confidence` a pixel has no disparity. Precondition: sizes agree.
  StereoPicture(const StereoGeometry& geometry, int width, int height,
                std::span<const std::uint8_t> pixels, std::span<const std::uint8_t> confidence = {},
                std::uint8_t least_confidence = 0);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const StereoGeometry& geometry() const { return geometry_; }

  /// kNone where there is none.
  [[nodiscard]] float disparity_px(int u, int v) const {
    return disparity_px_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                         static_cast<std::size_t>(u)];
  }
  void erase(int u, int v) {
    disparity_px_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(u)] = kNone;
  }
  /// Line of sight of a pixel, as far as z = 1.
  [[nodiscard]] Point sight(int u, int v) const {
    return {(u - geometry_.principal_u_px) / geometry_.focal_px,
            (v - geometry_.principal_v_px) / geometry_.focal_px, 1.0};
  }
  /// Precondition: the pixel has a disparity.
  [[nodiscard]] Point point(int u, int v) const {
    return scaled(sight(u, v),
                  geometry_.focal_baseline() / static_cast<double>(disparity_px(u, v)));
  }
  [[nodiscard]] std::size_t pixels_with_disparity() const;

 private:
  StereoGeometry geometry_;
  int width_;
  int height_;
  std::vector<float> disparity_px_;
};

}  // namespace rigwire::find_rocks
