// What the antenna supervisor reports: CFG-ANT says what it may detect.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 14.1 "Antenna supervisor" and
// 32.16.7 "UBX-MON-HW".
#pragma once

#include <cstdint>
#include <string_view>

#include "protocols/ubx/configuration.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct UbloxAntenna {
  std::uint8_t status = 2;  ///< MON-HW aStatus: 1 unknown, 2 OK, 3 short, 4 open.
  std::uint8_t power = 1;   ///< MON-HW aPower: 0 off, 1 on, 2 unknown.
  std::string_view text = "ANTSTATUS=OK";

  friend bool operator==(const UbloxAntenna&, const UbloxAntenna&) = default;
};

/// A NEO-7P detects shorts and switches the supply off; open circuits only when CFG-ANT says so. A
/// receiver that looks for neither (a ZED-F9P as delivered) does not know.
[[nodiscard]] inline UbloxAntenna supervise(AntennaState state,
                                            const protocols::ubx::CfgAnt& settings) {
  const auto has = [&](unsigned bit) { return (settings.flags >> bit & 1U) != 0; };
  const bool controls = has(0);
  const bool detects_short = has(1);
  const bool detects_open = has(2);
  const bool powers_down = has(3);
  const std::uint8_t power = controls ? 1 : 2;
  if (state == AntennaState::short_circuit && detects_short) {
    return {3, powers_down ? std::uint8_t{0} : power, "ANTSTATUS=SHORT"};
  }
  if (state == AntennaState::open && detects_open) {
    return {4, power, "ANTSTATUS=OPEN"};
  }
  if (!detects_short && !detects_open) {
    return {1, power, "ANTSTATUS=DONTKNOW"};
  }
  return {2, power, "ANTSTATUS=OK"};
}

}  // namespace rigwire::emulators
