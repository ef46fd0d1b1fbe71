// Terrain as heights on a square grid.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "sim/scene/node_rectangle.h"

namespace rigwire::sim {

/// Node (column c, row r) is at origin_m + cell_m * (c, r) in the world, x east and y north, at
/// heights_m[r * columns + c]. Each cell is two triangles, divided by the diagonal from its
/// south-east to its north-west node: the surface that the rays see and height_m() returns.
struct HeightField {
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
  double cell_m = 0.5;
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<double> heights_m;

  [[nodiscard]] double node(std::size_t column, std::size_t row) const {
    return heights_m[row * columns + column];
  }
  /// Height of the surface; beyond the edge that of the nearest point on the edge.
  [[nodiscard]] double height_m(double x_m, double y_m) const;
  /// Middle of the area, at the mean of lowest and highest node.
  [[nodiscard]] Eigen::Vector3d centre_m() const;
};

/// Returns the heights of these nodes of the field, row by row.
[[nodiscard]] std::vector<double> heights_in(const HeightField& field, const NodeRectangle& nodes);

/// Throws std::invalid_argument when there are fewer than 2 or more than 32767 nodes along a side
/// (the limit of the ray caster), the count of heights does not match, the cell is not positive, or
/// a height is not a finite number.
void validate(const HeightField& field);

}  // namespace rigwire::sim
