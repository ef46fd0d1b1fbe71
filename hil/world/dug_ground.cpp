#include "hil/world/dug_ground.h"

#include "sim/scene/height_field.h"

namespace rigwire::hil {

void DugNodes::follow(const WorldSlice& slice) {
  if (slice.dug) {
    nodes_ = nodes_ ? nodes_->joined(*slice.dug) : *slice.dug;
  }
}

std::optional<DugGround> DugNodes::take(const WorldSlice& slice) {
  if (!nodes_ || slice.ground == nullptr) {
    return std::nullopt;
  }
  DugGround dug{*nodes_, sim::heights_in(*slice.ground, *nodes_)};
  nodes_.reset();
  return dug;
}

}  // namespace rigwire::hil
