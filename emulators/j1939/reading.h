// How readings become what goes on the wire, and which group a number is.
#pragma once

#include <cmath>
#include <cstdint>

#include "protocols/vehicle/message.h"

namespace rigwire::emulators {

/// Error for what is no number.
[[nodiscard]] inline double reading(double value) {
  return std::isfinite(value) ? value : protocols::vehicle::kError;
}
/// Without its sign.
[[nodiscard]] inline double magnitude(double value) {
  return reading(std::abs(value));
}

/// Whether `pgn` is the message's group.
template <class Message>
[[nodiscard]] constexpr bool is(std::uint32_t pgn) {
  return Message::kGroup.pgn == pgn;
}

}  // namespace rigwire::emulators
