#include "dig_cycle/joint_control.h"

#include <algorithm>
#include <cmath>

namespace rigwire::dig_cycle {

JointControl::JointControl(const Machine& machine, const JointControlSettings& settings)
    : machine_(machine), settings_(settings) {}

PerJoint JointControl::update(const PerJoint& target_rad, const PerJoint& angle_rad,
                              double step_s) {
  for (std::size_t joint = 0; joint < kJoints; ++joint) {
    const double lower_rad = machine_.lower_rad[joint] + settings_.stop_margin_rad;
    const double upper_rad = machine_.upper_rad[joint] - settings_.stop_margin_rad;
    const double error_rad = std::clamp(target_rad[joint], lower_rad, upper_rad) - angle_rad[joint];
    const double dead_band =
        settings_.dead_band * std::clamp(error_rad / settings_.fine_error_rad, -1.0, 1.0);
    const bool curled = joint == bucket && angle_rad[joint] < settings_.curled_rad;
    const double largest = curled ? settings_.curled_opening : settings_.largest_opening[joint];
    double speed =
        std::clamp(error_rad * settings_.gain_per_rad[joint] + dead_band, -largest, largest);
    const double room_rad =
        speed > 0.0 ? upper_rad - angle_rad[joint] : angle_rad[joint] - lower_rad;
    speed *= std::clamp(room_rad / settings_.stop_approach_rad, 0.0, 1.0);

    const double wanted = speed * machine_.opening_sign[joint];
    const double step = settings_.slope_per_s * step_s;
    openings_[joint] += std::clamp(wanted - openings_[joint], -step, step);
    // At the stop nothing may linger from the slope.
    const double motion = openings_[joint] * machine_.opening_sign[joint];
    if ((motion > 0.0 && angle_rad[joint] >= upper_rad) ||
        (motion < 0.0 && angle_rad[joint] <= lower_rad)) {
      openings_[joint] = 0.0;
    }
  }
  return openings_;
}

}  // namespace rigwire::dig_cycle
