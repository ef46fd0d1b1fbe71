// The published nominal slots of the satellite systems, and the sets that their GPS satellites
// broadcast.
//
// GPS: the 24 slots of the SPS Performance Standard (2008, section 3.2), PRN = slot + 1. Each
// satellite issues its orbit every two hours, on even hours of GPS time, with toe = toc in the
// middle. The figures of the message are kept as whole numbers of its steps and change from one set
// to the next by whole steps; mean motion, drift of the node and clock drift are chosen so that two
// hours of each are a whole number too. Consecutive sets therefore agree within 2e-6 m; when the
// week turns the node's longitude is set anew, which moves an orbit by at most 2 cm. Resulting
// values:
//  - mean motion of one ground track a day (within 1.2e-4 deg/day), stated by axis (26 559.1 km)
//    and a delta n of its own for each satellite, 3.7e-9 .. 5.0e-9 rad/s (real ones: 3.7 to
//    5.1e-9); node -8.0e-9 rad/s as the earth's oblateness makes it;
//  - eccentricity 0.002 .. 0.010 by PRN (the standard allows 0.02), so that relativity shows;
//    argument of latitude as in the standard, for the mean;
//  - harmonics of each satellite's own, of the size that real messages carry: Crs within 115 m, Crc
//    131 .. 331 m, Cuc and Cus in step with them, Cic and Cis within 1.6e-7 rad;
//  - clocks within 2e-4 s, drifting by 1.46e-11 s/s one way for 13 weeks, then back; group delays
//    -9.3 .. 1.4 ns by PRN;
//  - issue of ephemeris 1 .. 239, of clock unique over 79 days (IS-GPS-200 section 20.3.4.4 asks
//    for 6 hours and 7 days).
//
// GLONASS (25 508 km, 64.8 deg), Galileo (29 600.318 km, 56 deg), BeiDou medium orbits (27 906 km,
// 55 deg): Walker 24/3/1, circular, first slot at the node and that at the origin of right
// ascension at the epoch. Their phase relative to GPS is not published; it is arbitrary here. QZSS:
// three satellites on one ground track about 135 deg east (42 164 km, 41 deg, e = 0.075) and one
// geostationary one at 127 deg east. SBAS: geostationary satellites of EGNOS, WAAS, MSAS and GAGAN.
// Broadcasts and motion of GLONASS, Galileo and BeiDou satellites: broadcast_orbits.h. QZSS and
// SBAS have ideal clocks and are pure Kepler orbits, smooth within 1e-3 m.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/gnss/constellation.h"

namespace rigwire::sim {

/// 1993-07-01 00:00:00 UTC: week 703, Thursday, GPS 9 s ahead of UTC.
inline constexpr std::int32_t kNominalEpochWeek = 703;
inline constexpr std::int64_t kNominalEpochOfWeek_s = 4 * 86'400 + 9;

/// A Kepler orbit over the turning earth. Angles at the epoch.
struct NominalOrbit {
  Satellite satellite;
  double semi_major_axis_m = 0.0;
  double eccentricity = 0.0;
  double inclination_rad = 0.0;
  double ascending_node_rad = 0.0;  ///< Longitude, earth-fixed.
  double argument_of_perigee_rad = 0.0;
  double mean_anomaly_rad = 0.0;
  double mean_motion_radps = 0.0;
};

/// By number; empty for GPS (see below) and for systems without nominal slots.
[[nodiscard]] std::vector<NominalOrbit> nominal_orbits(GnssSystem system);

[[nodiscard]] SatelliteState nominal_state(const NominalOrbit& orbit, const GpsTime& time,
                                           double offset_s);

/// Returns the two-hour interval since 1980-01-06 00:00 GPS that holds `time` plus `offset_s`.
[[nodiscard]] std::int64_t broadcast_interval(const GpsTime& time, double offset_s = 0.0);

/// Returns what satellite `prn` (1..24) broadcasts during an interval.
[[nodiscard]] GpsEphemeris nominal_gps_set(int prn, std::int64_t interval);

/// A moderate ionosphere, in the message's steps: 10 ns of amplitude at the equator.
[[nodiscard]] KlobucharParameters nominal_ionosphere();

/// UTC exactly as the built-in table of leap seconds has it. A leap second within half a year is
/// announced; otherwise the last one stays stated, as the satellites do.
[[nodiscard]] GpsUtcParameters nominal_utc(std::int64_t interval);

}  // namespace rigwire::sim
