#include "sim/scene/height_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace rigwire::sim {

double HeightField::height_m(double x_m, double y_m) const {
  const double u = std::clamp((x_m - origin_m.x()) / cell_m, 0.0, static_cast<double>(columns - 1));
  const double v = std::clamp((y_m - origin_m.y()) / cell_m, 0.0, static_cast<double>(rows - 1));
  const std::size_t c = std::min(static_cast<std::size_t>(u), columns - 2);
  const std::size_t r = std::min(static_cast<std::size_t>(v), rows - 2);
  const double fx = u - static_cast<double>(c);
  const double fy = v - static_cast<double>(r);
  const double south_east = node(c + 1, r);
  const double north_west = node(c, r + 1);
  // Plane of the south-western or of the north-eastern triangle.
  if (fx + fy <= 1.0) {
    const double south_west = node(c, r);
    return south_west + fx * (south_east - south_west) + fy * (north_west - south_west);
  }
  const double north_east = node(c + 1, r + 1);
  return north_east + (1.0 - fx) * (north_west - north_east) +
         (1.0 - fy) * (south_east - north_east);
}

Eigen::Vector3d HeightField::centre_m() const {
  const auto [lowest, highest] = std::ranges::minmax(heights_m);
  return {origin_m.x() + 0.5 * cell_m * static_cast<double>(columns - 1),
          origin_m.y() + 0.5 * cell_m * static_cast<double>(rows - 1), 0.5 * (lowest + highest)};
}

std::vector<double> heights_in(const HeightField& field, const NodeRectangle& nodes) {
  std::vector<double> heights_m;
  heights_m.reserve(nodes.nodes());
  for (std::size_t r = nodes.first_row; r <= nodes.last_row; ++r) {
    for (std::size_t c = nodes.first_column; c <= nodes.last_column; ++c) {
      heights_m.push_back(field.node(c, r));
    }
  }
  return heights_m;
}

void validate(const HeightField& field) {
  constexpr std::size_t kMostNodes = 32767;
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("height field: " + what);
  };
  for (const std::size_t nodes : {field.columns, field.rows}) {
    if (nodes < 2 || nodes > kMostNodes) {
      refuse("has " + std::to_string(nodes) + " nodes along a side, allowed: 2 to " +
             std::to_string(kMostNodes));
    }
  }
  if (field.heights_m.size() != field.columns * field.rows) {
    refuse("has " + std::to_string(field.heights_m.size()) + " heights for " +
           std::to_string(field.columns) + " x " + std::to_string(field.rows) + " nodes");
  }
  if (!(field.cell_m > 0.0) || !std::isfinite(field.cell_m) || !field.origin_m.allFinite()) {
    refuse("cell must be positive, cell and origin finite; cell is " +
           std::to_string(field.cell_m) + " m");
  }
  for (std::size_t i = 0; i < field.heights_m.size(); ++i) {
    if (!std::isfinite(field.heights_m[i])) {
      refuse("height at column " + std::to_string(i % field.columns) + ", row " +
             std::to_string(i / field.columns) + " is not a finite number");
    }
  }
}

}  // namespace rigwire::sim
