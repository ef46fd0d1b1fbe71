// An excavator operator's levers on USB, and what moves them.
//
//   levers:
//     type: usb-joystick
//     source: script
//     script:
//       - {at: 0 s}
//       - {at: 2 s, left_x: 1, buttons: [1]}
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "emulators/usb/hid_joystick.h"
#include "fields/visitor.h"
#include "hil/wires/usb_configuration.h"
#include "sim/joystick/lever_script.h"

namespace rigwire::hil {

enum class LeverSource { script, commands };
inline constexpr std::array<fields::Choice<LeverSource>, 2> kLeverSources{
    {{LeverSource::script, "script", "The keyframes of `script`."},
     {LeverSource::commands, "commands",
      "What the rig's valves are told, as an operator by the ISO pattern would."}}};

struct LeverKeyframeConfiguration {
  Duration at{0};                            ///< From the start of the run.
  std::array<double, kJoystickAxes> axes{};  ///< By JoystickAxis, of full travel.
  std::vector<double> buttons;               ///< Numbers of those that are pressed, 1 .. 16.
};

struct UsbJoystickConfiguration {
  static constexpr fields::Named kNamed{
      "usb-joystick", "Levers, pedals and buttons of an excavator's operator, a USB joystick."};

  emulators::HidJoystickSettings joystick;
  LeverSource source = LeverSource::script;
  bool repeat = false;
  std::vector<LeverKeyframeConfiguration> script;
  std::vector<UnplugConfiguration> unplugged;
};

/// Throws std::invalid_argument.
[[nodiscard]] inline sim::LeverScript lever_script(const UsbJoystickConfiguration& p) {
  std::vector<sim::LeverKeyframe> keyframes;
  for (const LeverKeyframeConfiguration& from : p.script) {
    sim::LeverKeyframe keyframe{from.at, from.axes, {}};
    for (const double button : from.buttons) {
      if (button != std::floor(button)) {
        throw std::invalid_argument("lever script buttons: found " + std::to_string(button) +
                                    ", allowed whole numbers 1 .. 16");
      }
      keyframe.buttons.set(static_cast<std::size_t>(std::lround(button)) - 1);
    }
    keyframes.push_back(keyframe);
  }
  return {std::move(keyframes), p.repeat};
}

inline void visit(fields::Visitor& v, LeverKeyframeConfiguration& p) {
  const auto axis = [&](JoystickAxis which) -> double& {
    return p.axes[static_cast<std::size_t>(which)];
  };
  const fields::NumberRule full = fields::plain().between(-1, 1);
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns}, "From the start of the run.");
  v.number("left_x", axis(JoystickAxis::left_x), full, "Left stick, right positive.");
  v.number("left_y", axis(JoystickAxis::left_y), full, "Left stick, back positive.");
  v.number("right_x", axis(JoystickAxis::right_x), full, "Right stick, right positive.");
  v.number("right_y", axis(JoystickAxis::right_y), full, "Right stick, back positive.");
  v.number("left_pedal", axis(JoystickAxis::left_pedal), full, "Forward positive.");
  v.number("right_pedal", axis(JoystickAxis::right_pedal), full, "Forward positive.");
  v.number("dial", axis(JoystickAxis::dial), fields::plain().between(0, 1), "Engine speed.");
  v.number_list("buttons", p.buttons, fields::plain().between(1, 16),
                "Those that are pressed, 1 .. 16.");
}

inline void visit(fields::Visitor& v, UsbJoystickConfiguration& p) {
  visit(v, p.joystick);
  v.choice("source", p.source, kLeverSources, "What moves the levers.");
  v.boolean("repeat", p.repeat, "The script begins again at its last keyframe.");
  v.list("script", p.script, "Keyframes; linear between them.");
  v.list("unplugged", p.unplugged, "When the plug is out.");
}

inline void validate(const UsbJoystickConfiguration& p) {
  validate(p.joystick);
  static_cast<void>(lever_script(p));
}

}  // namespace rigwire::hil
