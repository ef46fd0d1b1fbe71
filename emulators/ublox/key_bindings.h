// Which configuration items and which fields of the older CFG messages are the same thing.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, section 6.10 "Legacy
// UBX message fields reference". Time pulse: CFG-TP-PERIOD and LEN are the fields of CFG-TP5
// whatever its flags say, FREQ and DUTY stand for themselves. CFG-PRT, CFG-RATE and the others keep
// their meaning on a ZED-F9P; either way of writing is seen by the other.
#pragma once

#include <cstdint>
#include <span>

#include "emulators/ublox/configuration_state.h"

namespace rigwire::emulators {

/// A field of the state that is also an item.
struct UbloxKeyBinding {
  std::uint32_t key = 0;
  std::uint64_t (*read)(const UbloxConfigurationState& state) = nullptr;
  void (*write)(UbloxConfigurationState& state, std::uint64_t value) = nullptr;
};

/// Fields other than message rates.
[[nodiscard]] std::span<const UbloxKeyBinding> ublox_key_bindings();

}  // namespace rigwire::emulators
