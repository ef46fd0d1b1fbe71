// Settings of a J1939 node's identity: its NAME, and the texts of its identification messages.
//
// Values of the NAME: ISO 11783-1, annex, and SAE J1939 annex B as isobus.net and AgIsoStack have
// them. A function below 128 means the same in every industry group and device class; from 128 on
// it means something only together with both: 134 is the tractor ECU in group 2, class 0, and a
// centre hitch in class 1. Layout and sources of the answers: protocols/vehicle/identification.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "fields/visitor.h"
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

/// Printable ASCII without "*", up to 32 characters each.
struct IdentificationSettings {
  std::string make = "Rigwire";
  std::string model{};
  std::string unit_number{};  ///< Number of the machine that it belongs to.
  std::string software = "1.0";
  std::string part_number{};
  std::string type{};      ///< What kind of unit it is: "tractor ECU".
  std::string hardware{};  ///< Its revision.
  /// Vehicle identification number: 17 letters (no I, O, Q) and digits; empty: not known to this
  /// node.
  std::string vehicle_identification_number{};

  friend bool operator==(const IdentificationSettings&, const IdentificationSettings&) = default;
};

/// Its keys, among those of the device.
void visit(fields::Visitor& v, IdentificationSettings& p);

/// A text of which J1939 can send only what `fits`; `allowed` says in words what that is.
template <class Fits>
void visit_sendable(fields::Visitor& v, std::string_view key, std::string& value,
                    std::string_view text, const Fits& fits, const std::string& allowed) {
  v.text(key, value, text);
  v.check(fits(value), key, "cannot be sent", "\"" + value + "\"", allowed);
}

}  // namespace rigwire::emulators
