#include "dig_cycle/lanes.h"

#include <algorithm>

namespace rigwire::dig_cycle {

Lanes::Lanes(const LaneSettings& settings) : settings_(settings) {
  lanes_.push_back({.azimuth_rad = settings.middle_rad, .left_m = {}});
  for (int k = 1; k * settings.spacing_rad <= settings.sector_rad; ++k) {
    for (const double side : {1.0, -1.0}) {
      lanes_.push_back(
          {.azimuth_rad = settings.middle_rad + side * k * settings.spacing_rad, .left_m = {}});
    }
  }
}

double Lanes::ground_m(double seen_m) const {
  const double height_m = std::min(seen_m, lanes_[present_].left_m.value_or(seen_m));
  return std::max(height_m, settings_.depth_m - settings_.deepest_m);
}

void Lanes::cut(double ground_m, bool poor) {
  Lane& lane = lanes_[present_];
  lane.left_m = ground_m - settings_.depth_m;
  lane.poor = poor ? lane.poor + 1 : 0;
}

void Lanes::block() {
  lanes_[present_].blocked = true;
}

bool Lanes::done(const Lane& lane) const {
  constexpr double kRounding_m = 1e-6;
  return lane.blocked || lane.poor >= kMostPoor ||
         (lane.left_m && *lane.left_m <= kRounding_m - settings_.deepest_m);
}

bool Lanes::next() {
  std::optional<std::size_t> best;
  // What was not dug yet counts as high as the ground under the machine.
  const auto height_m = [this](std::size_t i) { return lanes_[i].left_m.value_or(0.0); };
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    if (!done(lanes_[i]) && (!best || height_m(i) > height_m(*best))) {
      best = i;
    }
  }
  present_ = best.value_or(present_);
  return best.has_value();
}

std::size_t Lanes::blocked() const {
  return static_cast<std::size_t>(std::ranges::count(lanes_, true, &Lane::blocked));
}

}  // namespace rigwire::dig_cycle
