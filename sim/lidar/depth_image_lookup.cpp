#include "sim/lidar/depth_image_lookup.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

/// A step continues the one beside it when they differ by no more than this share of that step and
/// this share of the inverse depth: then interpolation errs by less than 0.3 % of the range.
constexpr double kStepShare = 0.25;
constexpr double kDepthShare = 0.02;
/// A pixel's plane is trusted half a pixel away as long as its depth changes by no more than this.
constexpr double kGreatestTilt = 1.5;
/// Share of the far plane from which a mixture with it counts as nothing.
constexpr double kFarShare = 0.999;

/// The pixels around a place: four inner ones, and how far the place is between them.
struct Cell {
  std::size_t column = 0;
  std::size_t row = 0;
  double right = 0.0;
  double down = 0.0;
};

class Sampler {
 public:
  Sampler(const DepthImage& image, const Cell& cell) : image_(image), cell_(cell) {}

  /// Inverse depth of the pixel this many columns and rows from the cell's upper left one, which
  /// may be one pixel outside the cell, held at the image's edge.
  [[nodiscard]] double at(int columns, int rows) const {
    return image_.inverse_depth(image_.index(clamped(cell_.column, columns, image_.width_px()),
                                             clamped(cell_.row, rows, image_.height_px())));
  }
  [[nodiscard]] double bilinear(double w00, double w10, double w01, double w11) const {
    // Linear along both rows, then between them.
    const double above = w00 + cell_.right * (w10 - w00);
    const double below = w01 + cell_.right * (w11 - w01);
    return above + cell_.down * (below - above);
  }
  [[nodiscard]] bool continuous() const;

 private:
  static std::size_t clamped(std::size_t start, int step, std::size_t size) {
    const auto moved = static_cast<std::ptrdiff_t>(start) + step;
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(moved, 0, static_cast<std::ptrdiff_t>(size) - 1));
  }
  /// Whether b to c goes on as a to b or as c to d.
  static bool continues(double a, double b, double c, double d) {
    const double step = c - b;
    const double floor = kDepthShare * std::min(b, c);
    return std::abs(step - (b - a)) <= kStepShare * std::abs(b - a) + floor ||
           std::abs((d - c) - step) <= kStepShare * std::abs(d - c) + floor;
  }

  const DepthImage& image_;
  Cell cell_;
};

bool Sampler::continuous() const {
  if (std::min({at(0, 0), at(1, 0), at(0, 1), at(1, 1)}) <= 0.0) {
    return false;
  }
  return continues(at(-1, 0), at(0, 0), at(1, 0), at(2, 0)) &&
         continues(at(-1, 1), at(0, 1), at(1, 1), at(2, 1)) &&
         continues(at(0, -1), at(0, 0), at(0, 1), at(0, 2)) &&
         continues(at(1, -1), at(1, 0), at(1, 1), at(1, 2));
}

/// The cell that a coordinate in pixel centres is in, the outermost one if it is in none.
std::size_t cell_start(double coordinate, std::size_t size) {
  const double last = static_cast<double>(size) - 2.0;
  return static_cast<std::size_t>(std::clamp(std::floor(coordinate), 0.0, last));
}

std::size_t nearest_pixel(double coordinate, std::size_t size) {
  const double last = static_cast<double>(size) - 1.0;
  return static_cast<std::size_t>(std::clamp(std::round(coordinate), 0.0, last));
}

double interpolated_depth(const DepthImage& image, const Sampler& sampler) {
  const auto depth = [&](int column, int row) {
    const double inverse = sampler.at(column, row);
    return inverse > 0.0 ? 1.0 / inverse : image.far_m();
  };
  const double z = sampler.bilinear(depth(0, 0), depth(1, 0), depth(0, 1), depth(1, 1));
  return z > 0.0 && z < kFarShare * image.far_m() ? 1.0 / z : 0.0;
}

/// 1/z at a place, of the plane through a pixel.
double plane_inverse_depth(const DepthImage& image, const DepthImageGeometry& geometry,
                           std::size_t pixel, const ImagePoint& centre, const ImagePoint& at) {
  const double nearest = image.inverse_depth(pixel);
  const Eigen::Vector3d normal_S = image.normal_S(pixel).cast<double>();
  // On the plane 1 / z is in proportion to n . direction.
  const double tilt =
      normal_S.dot(geometry.direction_S(at)) / normal_S.dot(geometry.direction_S(centre));
  return tilt > 1.0 / kGreatestTilt && tilt < kGreatestTilt ? nearest * tilt : nearest;
}

}  // namespace

DepthLookup look_up(const DepthImage& image, const DepthImageGeometry& geometry,
                    const ImagePoint& at, DepthSampling sampling) {
  const double half_width = 0.5 * static_cast<double>(image.width_px());
  const auto height = static_cast<double>(image.height_px());
  const double x = std::clamp(at.u_px + half_width, 0.0, 2.0 * half_width) - 0.5;
  const double y = std::clamp(geometry.top_px() - at.v_px, 0.0, height) - 0.5;
  const std::size_t column = nearest_pixel(x, image.width_px());
  const std::size_t row = nearest_pixel(y, image.height_px());
  DepthLookup found;
  found.pixel = image.index(column, row);
  const double nearest = image.inverse_depth(found.pixel);
  if (sampling == DepthSampling::nearest) {
    found.inverse_depth = nearest;
    return found;
  }
  if (sampling == DepthSampling::tangent_plane) {
    if (nearest > 0.0) {
      const ImagePoint centre{at.camera, static_cast<double>(column) + 0.5 - half_width,
                              geometry.top_px() - static_cast<double>(row) - 0.5};
      found.inverse_depth = plane_inverse_depth(image, geometry, found.pixel, centre, at);
    }
    return found;
  }
  Cell cell;
  cell.column = cell_start(x, image.width_px());
  cell.row = cell_start(y, image.height_px());
  cell.right = x - static_cast<double>(cell.column);
  cell.down = y - static_cast<double>(cell.row);
  const Sampler sampler(image, cell);
  if (sampling == DepthSampling::bilinear_depth) {
    found.inverse_depth = interpolated_depth(image, sampler);
  } else if (sampling == DepthSampling::bilinear_inverse_depth || sampler.continuous()) {
    found.inverse_depth = std::max(0.0, sampler.bilinear(sampler.at(0, 0), sampler.at(1, 0),
                                                         sampler.at(0, 1), sampler.at(1, 1)));
  } else {
    found.inverse_depth = nearest;
  }
  return found;
}

}  // namespace rigwire::sim
