// What a node's NAME says of it, as keys: who made it and what it is.
//
// Values: ISO 11783-1, annex, and SAE J1939 annex B as isobus.net and AgIsoStack have them. A
// function below 128 means the same in every industry group and device class; from 128 on it means
// something only together with both: 134 is the tractor ECU in group 2, class 0, and a centre hitch
// in class 1.
#pragma once

#include <cstdint>

#include "fields/rules.h"
#include "protocols/j1939/name.h"

namespace rigwire::emulators {

// Functions.
inline constexpr std::uint8_t kVehicleNavigation = 23;
inline constexpr std::uint8_t kTractorEcu = 134;
// Industry groups.
inline constexpr std::uint8_t kAgriculture = 2;

struct J1939NameSettings {
  std::uint16_t manufacturer = 0;  ///< 0 .. 2047; 0 is reserved, and so no maker's.
  std::uint8_t function = 0;
  std::uint8_t function_instance = 0;  ///< 0 .. 31.
  std::uint8_t device_class = 0;       ///< 0 .. 127, "vehicle system" of J1939.
  std::uint8_t industry_group = 0;     ///< 0 .. 7.
};

/// Its keys, among those of the device.
void visit(fields::Visitor& v, J1939NameSettings& p);

[[nodiscard]] protocols::j1939::Name make_name(const J1939NameSettings& settings,
                                               std::uint32_t serial, bool arbitrary_address);

}  // namespace rigwire::emulators
