// RMC, VTG, GGA, GNS, GLL, ZDA, DTM and TXT exactly as u-blox receivers print them, NMEA 2.1
// to 4.11.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 31.1.6 "Position fix flags"
// and 31.2 "Standard Messages"; decimals, empty fields and padding from recordings of a NEO-7P:
// what is not known stays empty, the dilutions are then 99.99. Every number is within half a unit
// of its last decimal, and none is a negative zero.
#pragma once

#include <cstdint>
#include <string_view>

#include "protocols/nmea/epoch.h"
#include "protocols/nmea/readers.h"
#include "protocols/nmea/satellite_sentences.h"
#include "protocols/nmea/sentence.h"

namespace rigwire::protocols::nmea {

[[nodiscard]] Sentence write_rmc(const Epoch& epoch);
[[nodiscard]] Sentence write_vtg(const Epoch& epoch);
[[nodiscard]] Sentence write_gga(const Epoch& epoch);
/// The position mode has a letter for GPS and GLONASS, from 4.10 on for Galileo and BeiDou too; the
/// same for all systems that are switched on, as u-blox receivers do.
[[nodiscard]] Sentence write_gns(const Epoch& epoch);
[[nodiscard]] Sentence write_gll(const Epoch& epoch);
[[nodiscard]] Sentence write_zda(const Epoch& epoch);
/// Always WGS-84.
[[nodiscard]] Sentence write_dtm(const Epoch& epoch);

enum class TextKind : std::uint8_t { error = 0, warning = 1, notice = 2, user = 7 };
/// TXT in one part ("01,01").
[[nodiscard]] Sentence write_txt(std::string_view talker, TextKind kind, std::string_view text);

}  // namespace rigwire::protocols::nmea
