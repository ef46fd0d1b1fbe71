// An operator's levers over time, from keyframes.
//
// Axes move linearly from one keyframe to the next; buttons change at the keyframe. Before the
// first keyframe everything is as in the first, after the last as in the last, or from the start
// again where the script repeats: its period is the last keyframe's time.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <vector>

#include "sim/samples/joystick_sample.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::sim {

struct LeverKeyframe {
  Duration time{0};  ///< From the start of the run.
  std::array<double, kJoystickAxes> axes{};
  std::bitset<kJoystickButtons> buttons;
};

class LeverScript {
 public:
  /// Without keyframes the levers do not move. Throws std::invalid_argument when times do not
  /// increase, an axis is beyond its range, or a repeating script has no length.
  LeverScript(std::vector<LeverKeyframe> keyframes, bool repeat);

  [[nodiscard]] JoystickSample at(SimTime time) const;

 private:
  std::vector<LeverKeyframe> keyframes_;
  bool repeat_ = false;
};

/// Returns the levers of an operator who gives this valve command by the ISO pattern (ISO 10968):
/// left stick swing and stick, right stick bucket and boom. A positive opening swings left, lifts
/// the boom, and draws stick and bucket in (sim/excavator/excavator.h): levers left, back, back,
/// and left. Sections 4 and 5 are the left and the right pedal. A floating section leaves its lever
/// in the middle.
[[nodiscard]] JoystickSample levers_of(const ValveCommand& command, SimTime time);

}  // namespace rigwire::sim
