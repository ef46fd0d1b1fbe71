// Ground that changes, for sensors that look at it less often than it does.
#pragma once

#include <optional>
#include <vector>

#include "hil/world/world_sensor.h"
#include "sim/scene/node_rectangle.h"

namespace rigwire::hil {

/// Heights of nodes of the ground, row by row.
struct DugGround {
  sim::NodeRectangle nodes;
  std::vector<double> heights_m;
};

/// Where the ground was dug since it was last taken.
class DugNodes {
 public:
  /// Once for each slice.
  void follow(const WorldSlice& slice);
  /// Those nodes as they are at the end of the slice; nothing is left then. Nothing where nothing
  /// was dug.
  [[nodiscard]] std::optional<DugGround> take(const WorldSlice& slice);

 private:
  std::optional<sim::NodeRectangle> nodes_;
};

}  // namespace rigwire::hil
