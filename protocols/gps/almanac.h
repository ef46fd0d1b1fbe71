// The almanac: coarse orbits and health of all satellites, pages of subframes 4 and 5.
//
// Source: IS-GPS-200 section 20.3.3.5.1 and table 20-VI, figure 20-1 sheets 4 to 7. Units as in
// ephemeris.h; the inclination is whole here, the message carries it less 0.30 semicircles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "protocols/gps/ephemeris.h"
#include "protocols/gps/subframe.h"
#include "protocols/result.h"

namespace rigwire::protocols::gps {

inline constexpr std::size_t kSatellites = 32;

struct Almanac {
  std::uint8_t prn = 0;               ///< 1..32.
  std::int32_t week = 0;              ///< Week of almanac_time_s, not rolled over.
  std::uint8_t health = 0;            ///< 8 bits, 0 = all good.
  double almanac_time_s = 0.0;        ///< toa, time of week, a multiple of 4096 s.
  double clock_bias_s = 0.0;          ///< af0.
  double clock_drift = 0.0;           ///< af1, s/s.
  double sqrt_semi_major_axis = 0.0;  ///< sqrt(m).
  double eccentricity = 0.0;
  double mean_anomaly_rad = 0.0;         ///< M0.
  double ascending_node_rad = 0.0;       ///< OMEGA0, longitude at the start of the week.
  double inclination_rad = 0.0;          ///< 0.30 semicircles plus delta i.
  double argument_of_perigee_rad = 0.0;  ///< omega.
  double ascending_node_rate = 0.0;      ///< OMEGADOT, rad/s.

  friend bool operator==(const Almanac&, const Almanac&) = default;
};

/// Words 3..10 of a satellite's almanac page. Values beyond a field are clamped to it.
void put_almanac(SubframeData& data, const Almanac& almanac);

[[nodiscard]] Almanac quantised(const Almanac& almanac);

/// A page with satellite id 1..32; `week` is the almanac's, which the page does not carry.
/// Malformed for another id (offset 2, counted in words).
[[nodiscard]] Decoded<Almanac> decode_almanac(const SubframeData& data, std::int32_t week);

/// The satellite's orbit as an almanac for another time: mean anomaly and node are carried to it,
/// the axis is that of its whole mean motion, harmonic corrections are left out. Quantised.
[[nodiscard]] Almanac reduced(const Ephemeris& ephemeris, std::int32_t week, double almanac_time_s);

/// Returns the almanac as an ephemeris: toe and toc are its time, everything that it does not
/// contain is zero, the issue is the low byte of its time in steps of 4096 s.
[[nodiscard]] Ephemeris extended(const Almanac& almanac);

/// Health of all satellites, in two pages.
struct AlmanacHealth {
  std::int32_t week = 0;        ///< Week of the almanac; 8 bits in the message.
  double almanac_time_s = 0.0;  ///< A multiple of 4096 s.
  /// 6 bits, 0 = all good, 0x3F = do not use; PRN 1 first.
  std::array<std::uint8_t, kSatellites> health{};
  /// Anti-spoof flag and satellite configuration, 4 bits: 0b1001 = block II, anti-spoof on.
  std::array<std::uint8_t, kSatellites> configuration{};

  friend bool operator==(const AlmanacHealth&, const AlmanacHealth&) = default;
};

/// Words 3..10 of subframe 5 page 25: reference time and health of PRN 1..24.
void put_health_of_first(SubframeData& data, const AlmanacHealth& health);
/// Words 3..10 of subframe 4 page 25: configuration of all, health of PRN 25..32.
void put_health_of_last(SubframeData& data, const AlmanacHealth& health);

/// From both pages. Malformed when their ids are not 51 and 63 (offset 0 or 1: which page).
[[nodiscard]] Decoded<AlmanacHealth> decode_health(const SubframeData& first,
                                                   const SubframeData& last,
                                                   std::int32_t week_hint);

}  // namespace rigwire::protocols::gps
