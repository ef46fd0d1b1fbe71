// A rectangle of a height field's nodes, for instance those that changed.
#pragma once

#include <algorithm>
#include <cstddef>

namespace rigwire::sim {

/// Nodes of a height field, both ends included.
struct NodeRectangle {
  std::size_t first_column = 0;
  std::size_t first_row = 0;
  std::size_t last_column = 0;
  std::size_t last_row = 0;

  friend bool operator==(const NodeRectangle&, const NodeRectangle&) = default;

  /// Returns the number of nodes.
  [[nodiscard]] std::size_t nodes() const {
    return (last_column + 1 - first_column) * (last_row + 1 - first_row);
  }
  /// Returns the smallest rectangle that contains both.
  [[nodiscard]] NodeRectangle joined(const NodeRectangle& other) const {
    return {std::min(first_column, other.first_column), std::min(first_row, other.first_row),
            std::max(last_column, other.last_column), std::max(last_row, other.last_row)};
  }
};

}  // namespace rigwire::sim
