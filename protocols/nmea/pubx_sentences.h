// PUBX,00, PUBX,03 and PUBX,04: what u-blox receivers add to the standard sentences.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 31.3 "PUBX Messages"; padding
// and the fields without fix from published lines of u-blox 7 and M8 receivers (PUBX,04 of the
// former has no empty field at its end, unlike the document's example).
#pragma once

#include <cstdint>

#include "protocols/nmea/epoch.h"
#include "protocols/nmea/sentence.h"

namespace rigwire::protocols::nmea {

/// Most satellites of one PUBX,03, so that it fits a Sentence.
inline constexpr int kMostPubxSatellites = 40;

/// Position. Heights here are above the ellipsoid. Never empty: without fix the position is zero,
/// the state "NF".
[[nodiscard]] Sentence write_pubx_position(const Epoch& epoch);

/// Satellites; elevations below the horizon are negative.
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
/// Time and clock.
[[nodiscard]] Sentence write_pubx_time(const Epoch& epoch, const PubxTime& time);

}  // namespace rigwire::protocols::nmea
