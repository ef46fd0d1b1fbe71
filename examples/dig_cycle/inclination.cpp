#include "dig_cycle/inclination.h"

#include <algorithm>
#include <cmath>

#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {
namespace {

constexpr double kGravity_mps2 = 9.80665;

}  // namespace

Inclination::Inclination(const InclinationSettings& settings) : settings_(settings) {}

void Inclination::rate(double pitch_rate_radps, double step_s) {
  pitch_rate_radps_ = pitch_rate_radps - offset_radps_;
  if (ready_) {
    pitch_rad_ = wrapped(pitch_rad_ + pitch_rate_radps_ * step_s);
  }
}

void Inclination::specific_force(double along_mps2, double up_mps2, bool quiet, double step_s) {
  const double size_mps2 = std::hypot(along_mps2, up_mps2);
  if (!(std::abs(size_mps2 - kGravity_mps2) <= settings_.largest_gravity_deviation_mps2)) {
    return;
  }
  const double apparent_rad = std::atan2(along_mps2, up_mps2);
  if (!ready_) {
    pitch_rad_ = apparent_rad;
    ready_ = true;
    return;
  }
  const double error_rad = wrapped(apparent_rad - pitch_rad_);
  const double time_constant_s =
      quiet ? settings_.quiet_time_constant_s : settings_.moving_time_constant_s;
  pitch_rad_ = wrapped(pitch_rad_ + error_rad * std::min(1.0, step_s / time_constant_s));
  if (quiet) {
    const double change_radps =
        error_rad / settings_.quiet_time_constant_s * step_s / settings_.offset_time_constant_s;
    offset_radps_ = std::clamp(offset_radps_ - change_radps, -settings_.largest_offset_radps,
                               settings_.largest_offset_radps);
  }
}

}  // namespace rigwire::dig_cycle
