#include "emulators/valve_amplifier/stage.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {

void ValveStage::set_target(SimTime now, double command, const ValveStageParameters& parameters) {
  advance(now, parameters);
  target_ = command;
  advance(now, parameters);
}

void ValveStage::advance(SimTime now, const ValveStageParameters& parameters) {
  Duration left = now - moved_until_;
  moved_until_ = now;
  // At most two legs: down to neutral (or to a smaller command), then up with the new sign.
  for (int leg = 0; leg < 2 && ramped_ != target_; ++leg) {
    const bool other_sign = ramped_ * target_ < 0.0;
    const bool down = other_sign || std::abs(target_) < std::abs(ramped_);
    const double goal = other_sign ? 0.0 : target_;
    const Duration full = down ? parameters.ramp_down : parameters.ramp_up;
    const Duration needed = from_seconds(to_seconds(full) * std::abs(goal - ramped_));
    if (needed <= left) {
      ramped_ = goal;
      left -= needed;
      continue;
    }
    // Linear ramp: full travel in the ramp's time.
    const double step = to_seconds(left) / to_seconds(full);
    ramped_ += goal > ramped_ ? step : -step;
    return;
  }
}

void ValveStage::neutral(SimTime now) {
  moved_until_ = now;
  target_ = 0.0;
  ramped_ = 0.0;
}

double ValveStage::opening(const ValveStageParameters& parameters) const {
  const double command = std::clamp(ramped_ * parameters.gain, -1.0, 1.0);
  if (command == 0.0) {
    return 0.0;
  }
  const double band = command > 0.0 ? parameters.dead_band_positive : parameters.dead_band_negative;
  // Dead band compensation: b + (1 - b) |c|.
  const double travel = band + (1.0 - band) * std::abs(command);
  return parameters.polarity * std::copysign(travel, command);
}

}  // namespace rigwire::emulators
