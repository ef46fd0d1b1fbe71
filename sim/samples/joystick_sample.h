// What an operator does with levers, pedals and buttons at one instant.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>

#include "sim/samples/time.h"

namespace rigwire {

/// Levers of an excavator's operator: two sticks, two travel pedals, the engine-speed dial.
enum class JoystickAxis : std::size_t {
  left_x,       ///< Right positive.
  left_y,       ///< Pulled towards the operator positive.
  right_x,      ///< Right positive.
  right_y,      ///< Pulled towards the operator positive.
  left_pedal,   ///< Pushed forward positive.
  right_pedal,  ///< Pushed forward positive.
  dial,         ///< 0 slow .. 1 fast.
};
inline constexpr std::size_t kJoystickAxes = 7;
inline constexpr std::size_t kJoystickButtons = 16;

struct JoystickSample {
  SimTime time{};
  std::array<double, kJoystickAxes> axes{};  ///< -1 .. 1 of full travel; the dial 0 .. 1.
  std::bitset<kJoystickButtons> buttons;     ///< Pressed.

  [[nodiscard]] double axis(JoystickAxis axis) const {
    return axes[static_cast<std::size_t>(axis)];
  }
  friend bool operator==(const JoystickSample&, const JoystickSample&) = default;
};

}  // namespace rigwire
