// Position, velocity and clock of a satellite from what it broadcasts, as every receiver works them
// out: IS-GPS-200 section 20.3.3.4.3 with table 20-IV, clock 20.3.3.3.3.1. Galileo and BeiDou have
// the same equations (Galileo OS SIS ICD 5.1.1, BDS-SIS-ICD 5.2.4.12) for an earth of their own.
//
// Position and velocity are earth-fixed at the instant asked for and good to 1e-6 m and 1e-9 m/s
// against exact arithmetic; the velocity is the analytic derivative of the position.
#pragma once

#include "sim/gnss/constellation.h"

namespace rigwire::sim {

inline constexpr double kWeek_s = 604'800.0;
inline constexpr std::int64_t kWeek_ns = 604'800LL * 1'000'000'000;
/// The number of half turns in a radian is fixed too, so that every user decodes the same angle.
inline constexpr double kSemicircle_rad = 3.1415926535898;

/// Gravity and rotation of the earth that a system's users reckon with.
struct OrbitConstants {
  double gravity_m3ps2 = kEarthGravity_m3ps2;
  double rotation_radps = kEarthRate_radps;
};
inline constexpr OrbitConstants kEarthOfGps{};
inline constexpr OrbitConstants kEarthOfGalileo{3.986'004'418e14, 7.292'115'146'7e-5};
inline constexpr OrbitConstants kEarthOfBeidou{3.986'004'418e14, 7.292'115'0e-5};

/// `time` plus `offset_s`, less the instant `time_of_week_s` of `week`. Nanoseconds are subtracted
/// as integers; `time_of_week_s` is a whole number of nanoseconds.
[[nodiscard]] double seconds_between(std::int32_t week, double time_of_week_s, const GpsTime& time,
                                     double offset_s = 0.0);

/// Kepler's equation M = E - e sin E, solved by Newton to rounding; 0 <= eccentricity < 0.1. The
/// result lies within e of `mean_anomaly_rad`.
[[nodiscard]] double eccentric_anomaly(double mean_anomaly_rad, double eccentricity);

/// Returns the state that a user computes. Times since toe and toc are taken modulo a week, within
/// half a week (a set carries no week), so a set of another week is applied as if it were of the
/// nearest.
[[nodiscard]] SatelliteState satellite_state(const GpsEphemeris& ephemeris, const GpsTime& time,
                                             double offset_s = 0.0,
                                             const OrbitConstants& earth = kEarthOfGps);

/// Every value rounded to the step in which the message carries it (tables 20-I and 20-III); angles
/// first brought to [-pi, pi). Throws std::invalid_argument naming a quantity that the message
/// cannot hold.
[[nodiscard]] GpsEphemeris quantised(const GpsEphemeris& ephemeris);

/// Returns the same orbit and clock for a reference time `later_s` later (or earlier, when
/// negative; a multiple of 16 s), as the next upload would state it, quantised: at its own
/// reference time it is within 4 cm of the orbit that it continues. Adds `issues` to the issue
/// numbers. A clock is continued for a week and then stays, so that no drift leaves the field's
/// range. Precondition: quantised.
[[nodiscard]] GpsEphemeris reissued(const GpsEphemeris& ephemeris, std::int64_t later_s,
                                    std::int64_t issues);

}  // namespace rigwire::sim
