// How NMEA numbers satellites, systems and signals, by version.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, appendices A "Satellite Numbering" and
// B "UBX and NMEA Signal Identifiers", section 31.1.2 "Talker ID"; ZED-F9P interface description
// HPG 1.50, UBXDOC-963802114-12815, section 1.5 and 2.5.1.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "protocols/nmea/epoch.h"

namespace rigwire::protocols::nmea {

/// CFG-NMEA svNumbering.
enum class Numbering : std::uint8_t { strict = 0, extended = 1 };

/// The number that sentences print. `number`: within its system, GPS 1..32, SBAS PRN 120..158,
/// Galileo 1..36, BeiDou 1..63, QZSS 1..10, GLONASS slot 1..32. Empty when such a satellite is not
/// printed at all in that version and numbering; 0 (prints as an empty field) for a GLONASS
/// satellite outside 1..32, which is one not identified yet.
[[nodiscard]] std::optional<int> satellite_number(System system, int number, Version version,
                                                  Numbering numbering);

/// The number in the UBX scheme of one byte, as PUBX,03 and older UBX messages have it; 255 when it
/// has none.
[[nodiscard]] int single_satellite_number(System system, int number);

/// Systems whose satellites share GSA and GSV: SBAS goes with GPS, QZSS too before version 4.11.
[[nodiscard]] System satellite_group(System system, Version version);
/// The groups in the order in which sentences come.
inline constexpr std::array kSatelliteGroups{System::gps, System::glonass, System::galileo,
                                             System::beidou, System::qzss};

/// The digit of version 4.10 and later for a group.
[[nodiscard]] int system_identifier(System group);
/// The digit of version 4.10 and later for the signal of that system near 1.6 GHz (L1, E1, B1).
[[nodiscard]] std::uint8_t first_signal(System system);
/// "GP", "GL", "GA", "GB", "GQ".
[[nodiscard]] std::string_view group_talker(System group);
/// "GN" when the systems are of several groups.
[[nodiscard]] std::string_view main_talker(unsigned systems, Version version);

}  // namespace rigwire::protocols::nmea
