#include "dig_cycle/load_scale.h"

#include <algorithm>

namespace rigwire::dig_cycle {

void LoadScale::tare() {
  if (full()) {
    empty_n_ = sum_n_ / samples_;
  }
}

std::optional<double> LoadScale::load_kg(const PerJoint& angles_rad) const {
  constexpr double kGravity_mps2 = 9.80665;
  const double reach_m = load_reach_m(machine_, angles_rad);
  if (!full() || !empty_n_ || !(reach_m > 0.0)) {
    return std::nullopt;
  }
  const double more_n = sum_n_ / samples_ - *empty_n_;
  return std::max(0.0,
                  more_n * boom_lever_m(machine_, angles_rad[boom]) / (kGravity_mps2 * reach_m));
}

}  // namespace rigwire::dig_cycle
