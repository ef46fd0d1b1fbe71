#include "sim/roller/supplements.h"

#include <algorithm>
#include <cmath>

#include "sim/roller/require.h"

namespace rigwire::sim {
namespace {

constexpr double kStanding_mps = 1e-3;  // Below, nothing is sprinkled.

void check_filling(const char* where, double capacity_kg, double initial_kg) {
  require_not_negative(where, "capacity_kg", capacity_kg);
  require_number(initial_kg >= 0.0 && initial_kg <= capacity_kg, where, "initial_kg", initial_kg,
                 "0 .. capacity_kg");
}

}  // namespace

void validate(const SprinklerParameters& p, const char* where) {
  check_filling(where, p.capacity_kg, p.initial_kg);
  require_not_negative(where, "flow_kgps", p.flow_kgps);
  require_finite_number(where, "x_m", p.x_m);
  require_not_negative(where, "height_m", p.height_m);
}

void validate(const SpreaderParameters& p, const char* where) {
  check_filling(where, p.capacity_kg, p.initial_kg);
  require_not_negative(where, "width_m", p.width_m);
  require_not_negative(where, "rate_max_kgpm2", p.rate_max_kgpm2);
  require_finite_number(where, "x_m", p.x_m);
  require_not_negative(where, "height_m", p.height_m);
}

void validate(const EdgeCutterParameters& p, const char* where) {
  require_not_negative(where, "lift_m", p.lift_m);
  require_positive(where, "lift_time_s", p.lift_time_s);
  require_number(p.press_share >= 0.0 && p.press_share < 1.0, where, "press_share", p.press_share,
                 ">= 0 and < 1");
  require_not_negative(where, "lateral_n", p.lateral_n);
  require_positive(where, "moving_mps", p.moving_mps);
  require_finite_number(where, "x_m", p.x_m);
  require_finite_number(where, "y_m", p.y_m);
}

void Sprinkler::step(double h, double speed_mps) {
  if (std::abs(speed_mps) > kStanding_mps) {
    mass_kg_ = std::max(0.0, mass_kg_ - parameters_.flow_kgps * h);
  }
}

void ChipSpreader::command(double rate_kgpm2) {
  if (std::isfinite(rate_kgpm2)) {
    rate_kgpm2_ = std::clamp(rate_kgpm2, 0.0, parameters_.rate_max_kgpm2);
  }
}

void ChipSpreader::step(double h, double speed_mps) {
  // Mass flow = speed x width x rate.
  mass_kg_ = std::max(0.0, mass_kg_ - std::abs(speed_mps) * parameters_.width_m * rate_kgpm2_ * h);
}

void EdgeCutter::command(double share) {
  if (std::isfinite(share)) {
    wanted_ = std::clamp(share, 0.0, 1.0);
  }
}

void EdgeCutter::step(double h) {
  const double way = h / parameters_.lift_time_s;
  share_ += std::clamp(wanted_ - share_, -way, way);
}

double EdgeCutter::lateral_n(double speed_mps) const {
  // Side force grows linearly with the press and with the speed up to moving_mps.
  const double pressed = std::max(0.0, share_ - parameters_.press_share);
  const double moving = std::min(1.0, std::abs(speed_mps) / parameters_.moving_mps);
  const double away = parameters_.y_m > 0.0 ? -1.0 : 1.0;
  return away * parameters_.lateral_n * moving * pressed / (1.0 - parameters_.press_share);
}

}  // namespace rigwire::sim
