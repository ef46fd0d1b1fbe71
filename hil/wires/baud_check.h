// Whether a serial line minds that its client is set to another speed.
#pragma once

#include <array>
#include <cstdint>

#include "fields/visitor.h"

namespace rigwire::hil {

enum class BaudCheck {
  /// As strict, but 9600 bit/s passes: gpsd sets it on every pseudo-terminal and never hunts for
  /// another speed there, and libraries set it for programs that ask for none.
  lenient,
  strict,  ///< As on a wire: a client at another speed hears garbage and is heard as garbage.
  none,    ///< Every client is understood.
};
inline constexpr std::array<fields::Choice<BaudCheck>, 3> kBaudChecks{
    {{BaudCheck::lenient, "lenient", "At another speed than the device's, 9600 bit/s excepted."},
     {BaudCheck::strict, "strict", "At another speed than the device's, as on a wire."},
     {BaudCheck::none, "none", "Never."}}};

/// The client's speed as the device is to see it; 0 = not known, so that it matches.
[[nodiscard]] constexpr std::uint32_t seen_baud(BaudCheck check, std::uint32_t client_baud) {
  constexpr std::uint32_t kUnchosen = 9600;
  const bool passes =
      check == BaudCheck::none || (check == BaudCheck::lenient && client_baud == kUnchosen);
  return passes ? 0 : client_baud;
}

}  // namespace rigwire::hil
