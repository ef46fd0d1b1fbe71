#include "sim/joystick/lever_script.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr std::size_t index_of(JoystickAxis axis) {
  return static_cast<std::size_t>(axis);
}

void validate(const std::vector<LeverKeyframe>& keyframes, bool repeat) {
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const std::string where = "lever script keyframe " + std::to_string(i);
    if (keyframes[i].time < Duration{0} || (i > 0 && keyframes[i].time <= keyframes[i - 1].time)) {
      throw std::invalid_argument(where + ": time " +
                                  std::to_string(to_seconds(keyframes[i].time)) +
                                  " s is not later than the one before");
    }
    for (std::size_t axis = 0; axis < kJoystickAxes; ++axis) {
      const double value = keyframes[i].axes[axis];
      const double least = axis == index_of(JoystickAxis::dial) ? 0.0 : -1.0;
      if (!(value >= least && value <= 1.0)) {
        throw std::invalid_argument(where + ": axis " + std::to_string(axis) + " found " +
                                    std::to_string(value) + ", allowed " +
                                    std::to_string(static_cast<int>(least)) + " .. 1");
      }
    }
  }
  if (repeat && (keyframes.empty() || keyframes.back().time == Duration{0})) {
    throw std::invalid_argument("lever script: one that repeats ends later than 0 s");
  }
}

}  // namespace

LeverScript::LeverScript(std::vector<LeverKeyframe> keyframes, bool repeat)
    : keyframes_(std::move(keyframes)), repeat_(repeat) {
  validate(keyframes_, repeat_);
}

JoystickSample LeverScript::at(SimTime time) const {
  JoystickSample sample;
  sample.time = time;
  if (keyframes_.empty()) {
    return sample;
  }
  Duration passed = time - kStart;
  if (repeat_) {
    passed %= keyframes_.back().time;
  }
  const auto next = std::ranges::upper_bound(keyframes_, passed, {}, &LeverKeyframe::time);
  const LeverKeyframe& before = next == keyframes_.begin() ? *next : *std::prev(next);
  const LeverKeyframe& after = next == keyframes_.end() ? before : *next;
  // Linear between the keyframes; buttons as of the one before.
  const double whole = to_seconds(after.time - before.time);
  const double share = whole > 0.0 ? to_seconds(passed - before.time) / whole : 0.0;
  for (std::size_t axis = 0; axis < kJoystickAxes; ++axis) {
    sample.axes[axis] = before.axes[axis] + share * (after.axes[axis] - before.axes[axis]);
  }
  sample.buttons = before.buttons;
  return sample;
}

JoystickSample levers_of(const ValveCommand& command, SimTime time) {
  struct Lever {
    JoystickAxis axis;
    std::size_t section;
    double sign;
  };
  constexpr std::array<Lever, 6> kLevers{{{JoystickAxis::left_x, 0, -1.0},
                                          {JoystickAxis::right_y, 1, 1.0},
                                          {JoystickAxis::left_y, 2, 1.0},
                                          {JoystickAxis::right_x, 3, -1.0},
                                          {JoystickAxis::left_pedal, 4, 1.0},
                                          {JoystickAxis::right_pedal, 5, 1.0}}};
  JoystickSample sample;
  sample.time = time;
  for (const Lever& lever : kLevers) {
    if (!command.floating[lever.section]) {
      sample.axes[index_of(lever.axis)] = lever.sign * command.opening[lever.section];
    }
  }
  return sample;
}

}  // namespace rigwire::sim
