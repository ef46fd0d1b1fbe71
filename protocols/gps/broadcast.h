// What a satellite sends when: the schedule of subframes and pages, and the composition of each.
//
// Source: IS-GPS-200 sections 20.3.2 and 20.3.4.1: subframes 1 to 5 in turn, from the start of the
// week; subframes 4 and 5 go through 25 pages in 12.5 minutes and begin with page 1 at the start of
// every week. All satellites send the same page at the same time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocols/gps/almanac.h"
#include "protocols/gps/ephemeris.h"
#include "protocols/gps/page.h"
#include "protocols/gps/subframe.h"

namespace rigwire::protocols::gps {

/// The time at which a subframe begins: a step of 6 s of a GPS week.
struct Step {
  std::int32_t week = 0;   ///< Since 1980-01-06, not rolled over.
  std::uint32_t step = 0;  ///< 0..100799.

  friend bool operator==(const Step&, const Step&) = default;
};

struct ScheduledSubframe {
  std::uint8_t subframe_id = 1;  ///< 1..5.
  std::uint8_t page = 1;         ///< 1..25; subframes 1 to 3 have no pages but go with one.

  friend bool operator==(const ScheduledSubframe&, const ScheduledSubframe&) = default;
};

[[nodiscard]] ScheduledSubframe scheduled(std::uint32_t step);

/// Everything that the satellites send.
struct Broadcast {
  std::array<std::optional<Ephemeris>, kSatellites> ephemerides;  ///< By PRN - 1.
  std::array<std::optional<Almanac>, kSatellites> almanacs;       ///< By PRN - 1.
  AlmanacHealth health;
  IonosphereUtc ionosphere_utc;
};

/// Fills `almanacs` and `health` from the ephemerides: one almanac time for all, which is the
/// multiple of 4096 s nearest to the noon of the GPS day of the earliest ephemeris. Satellites
/// without ephemeris are marked 0x3F, do not use.
void derive_almanac(Broadcast& broadcast);

/// The subframe that satellite `prn` begins to send at `time`; pages with nothing to say are
/// filled. Without an ephemeris of its own, subframes 1 to 3 are filled with ones and zeros too, as
/// a satellite without upload does. Precondition: prn 1..32, time.step < 100800.
[[nodiscard]] Subframe subframe_at(const Broadcast& broadcast, std::uint8_t prn, const Step& time);

}  // namespace rigwire::protocols::gps
