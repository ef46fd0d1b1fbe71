// Sentences exactly as u-blox receivers print them, NMEA 2.1 to 4.11: position, satellites and what
// they make of the fix, and what PUBX adds.
//
// GSA, GRS and GSV come in several sentences, numbered from 1: one GSA and GRS for each group of
// satellites (satellite_numbers.h) when Epoch::systems names several; GSV in pages of four
// satellites, for each group and, from version 4.10 on, each signal. The order of satellites is
// that of the epoch, sentences of a group keep together.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 31.1.6 "Position fix flags",
// 31.2 "Standard Messages" and 31.3 "PUBX Messages"; ZED-F9P interface description HPG 1.50,
// UBXDOC-963802114-12815, section 2.4 "NMEA multi-GNSS operation"; decimals, empty fields and
// padding from recordings of a NEO-7P: unknown values stay empty, the dilutions are then 99.99, the
// last GSV page is not padded. GST with two significant digits as M8 and F9 print it. PUBX: padding
// and the fields without fix from published lines of u-blox 7 and M8 receivers (PUBX,04 of the
// former has no empty field at its end, unlike the document's example). Every number is within half
// a unit of its last decimal, and none is a negative zero.
#pragma once

#include <cstdint>
#include <string_view>

#include "protocols/nmea/epoch.h"
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

[[nodiscard]] int gsa_sentences(const Epoch& epoch);
[[nodiscard]] Sentence write_gsa(const Epoch& epoch, int sentence);

[[nodiscard]] int grs_sentences(const Epoch& epoch);
/// Residuals of the satellites of the GSA of the same number.
[[nodiscard]] Sentence write_grs(const Epoch& epoch, int sentence);

/// At most 5 pages of one set up to version 2.3, 9 later.
[[nodiscard]] int gsv_pages(const Epoch& epoch);
[[nodiscard]] Sentence write_gsv(const Epoch& epoch, int page);

/// Empty but for the time without error statistics; the ellipse is always left empty, as most
/// u-blox receivers do.
[[nodiscard]] Sentence write_gst(const Epoch& epoch);

/// No satellite is at fault.
[[nodiscard]] Sentence write_gbs(const Epoch& epoch);

/// PUBX,00: position. Heights here are above the ellipsoid. Never empty: without fix the position
/// is zero, the state "NF".
[[nodiscard]] Sentence write_pubx_position(const Epoch& epoch);

/// Most satellites of one PUBX,03, so that it fits a Sentence.
inline constexpr int kMostPubxSatellites = 40;
/// PUBX,03: satellites; elevations below the horizon are negative.
[[nodiscard]] Sentence write_pubx_satellites(const Epoch& epoch);

struct PubxTime {
  std::int64_t time_of_week_hundredths = 0;  ///< UTC, since Sunday, rounded as Epoch::time is.
  int week = 0;                              ///< UTC, not rolled over.
  int leap_seconds = 0;
  bool leap_seconds_received = false;  ///< Otherwise the firmware's default, marked "D".
  double clock_bias_ns = 0.0;
  double clock_drift_nsps = 0.0;
  int pulse_granularity_ns = 0;
};
/// PUBX,04: time and clock.
[[nodiscard]] Sentence write_pubx_time(const Epoch& epoch, const PubxTime& time);

}  // namespace rigwire::protocols::nmea
