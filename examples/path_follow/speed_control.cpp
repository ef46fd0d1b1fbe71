#include "path_follow/speed_control.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace rigwire::path_follow {
namespace {

/// Slower than this nothing is learnt: the clutch may slip.
constexpr double kLearn_mps = 0.8;
constexpr double kLearn_s = 2.0;
constexpr double kIntegralLimit_mps = 0.5;

}  // namespace

SpeedControl::SpeedControl(const SpeedControlSettings& settings, double cruise_mps,
                           std::optional<int> gear)
    : settings_(settings) {
  const int gears = static_cast<int>(settings_.engine_per_speed.size());
  if (gear) {
    if (*gear < 1 || *gear > gears) {
      throw std::invalid_argument("gear is " + std::to_string(*gear) + ", allowed 1 to " +
                                  std::to_string(gears));
    }
    gear_ = *gear;
  } else {
    const auto needs = [&](int g) {
      return cruise_mps * settings_.engine_per_speed[static_cast<std::size_t>(g - 1)];
    };
    while (gear_ < gears && (needs(gear_) > settings_.engine_cruise_radps) &&
           needs(gear_ + 1) > settings_.engine_least_radps) {
      ++gear_;
    }
  }
  engine_per_speed_ = settings_.engine_per_speed[static_cast<std::size_t>(gear_ - 1)];
}

SpeedOutput SpeedControl::update(double wish_mps, double speed_mps, double engine_radps,
                                 bool in_gear, double step_s) {
  const double nominal = settings_.engine_per_speed[static_cast<std::size_t>(gear_ - 1)];
  if (in_gear && speed_mps > kLearn_mps) {
    const double seen = std::clamp(engine_radps / speed_mps, 0.7 * nominal, 1.4 * nominal);
    engine_per_speed_ += (seen - engine_per_speed_) * std::min(1.0, step_s / kLearn_s);
  }
  SpeedOutput output;
  const double error = wish_mps - speed_mps;
  if (wish_mps <= 0.0) {
    integral_mps_ = 0.0;
    output.engine_radps = settings_.engine_idle_radps;
  } else {
    // Below the clutch's closing speed the integral presses it until the vehicle creeps.
    const double wanted = std::max(settings_.engine_idle_radps,
                                   engine_per_speed_ * (wish_mps + settings_.gain * error)) +
                          engine_per_speed_ * integral_mps_;
    output.engine_radps =
        std::clamp(wanted, settings_.engine_idle_radps, settings_.engine_most_radps);
    if (wanted < settings_.engine_most_radps || error < 0.0) {
      integral_mps_ = std::clamp(integral_mps_ + settings_.integral_per_s * error * step_s,
                                 -kIntegralLimit_mps, kIntegralLimit_mps);
    }
  }
  const double over_mps = -error - (wish_mps > 0.0 ? settings_.brake_from_mps : 0.0);
  output.brake_mps2 =
      std::clamp(settings_.brake_gain_per_s * over_mps, 0.0, settings_.brake_most_mps2);
  return output;
}

}  // namespace rigwire::path_follow
