// What navigation satellites broadcast about their orbits and clocks, in SI units and radians.
//
// Every value is a whole number of the steps in which the message carries it (GPS: the legacy
// message, IS-GPS-200, section 20.3.3), so that encoding it loses nothing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace rigwire {

/// Clock and orbit of one satellite: IS-GPS-200 tables 20-I and 20-III. Times of week are GPS.
/// Galileo and BeiDou state the same figures: Galileo by GPS time too, BeiDou by its own, which is
/// 14 s late (its weeks here are those of GPS). What only GPS has is 0 for them.
struct GpsEphemeris {
  std::uint8_t prn = 0;              ///< 1..32.
  std::int32_t week = 0;             ///< Week of toe, not rolled over.
  std::uint16_t issue_of_clock = 0;  ///< IODC, 10 bits; its low byte is issue_of_ephemeris.
  std::uint8_t issue_of_ephemeris = 0;
  std::uint8_t accuracy_index = 0;  ///< URA, 0..15.
  std::uint8_t health = 0;          ///< 6 bits, 0 = all signals good.
  double group_delay_s = 0.0;       ///< TGD.
  /// Galileo: for E5a (group_delay_s is for E5b); BeiDou: for B2I; GPS: none.
  double second_delay_s = 0.0;
  double clock_time_s = 0.0;          ///< toc, time of week.
  double clock_bias_s = 0.0;          ///< af0.
  double clock_drift = 0.0;           ///< af1, s/s.
  double clock_drift_rate = 0.0;      ///< af2, s/s2.
  double ephemeris_time_s = 0.0;      ///< toe, time of week.
  double sqrt_semi_major_axis = 0.0;  ///< sqrt(m).
  double eccentricity = 0.0;
  double mean_anomaly_rad = 0.0;         ///< M0.
  double mean_motion_difference = 0.0;   ///< Delta n, rad/s.
  double ascending_node_rad = 0.0;       ///< OMEGA0, longitude at the start of the week.
  double inclination_rad = 0.0;          ///< i0.
  double argument_of_perigee_rad = 0.0;  ///< omega.
  double ascending_node_rate = 0.0;      ///< OMEGADOT, rad/s.
  double inclination_rate = 0.0;         ///< IDOT, rad/s.
  double latitude_cosine_rad = 0.0;      ///< Cuc.
  double latitude_sine_rad = 0.0;        ///< Cus.
  double radius_cosine_m = 0.0;          ///< Crc.
  double radius_sine_m = 0.0;            ///< Crs.
  double inclination_cosine_rad = 0.0;   ///< Cic.
  double inclination_sine_rad = 0.0;     ///< Cis.

  friend bool operator==(const GpsEphemeris&, const GpsEphemeris&) = default;
};

/// Klobuchar's model of the ionosphere: IS-GPS-200 section 20.3.3.5.2.5. Units s, s/semicircle, ...
struct KlobucharParameters {
  std::array<double, 4> alpha{};
  std::array<double, 4> beta{};

  friend bool operator==(const KlobucharParameters&, const KlobucharParameters&) = default;
};

/// GPS time to UTC: IS-GPS-200 section 20.3.3.5.2.4.
struct GpsUtcParameters {
  double a0_s = 0.0;
  double a1 = 0.0;  ///< s/s.
  double reference_time_s = 0.0;
  std::int32_t reference_week = 0;  ///< Not rolled over.
  std::int32_t leap_seconds = 0;
  std::int32_t leap_week = 0;  ///< Week and day (1..7) at whose end leap_seconds_future begins.
  std::int32_t leap_day = 1;
  std::int32_t leap_seconds_future = 0;

  friend bool operator==(const GpsUtcParameters&, const GpsUtcParameters&) = default;
};

/// Orbit and clock of a GLONASS satellite: GLONASS ICD 5.1, table 4.5. Earth-fixed, PZ-90.
struct GlonassEphemeris {
  std::uint8_t slot = 0;  ///< 1..24.
  /// Its middle, by GLONASS' time (UTC and three hours): seconds of the day, day within the four
  /// years that begin with a leap year (1..1461), and which four years these are (1: 1996).
  std::int32_t time_of_day_s = 0;
  std::int32_t day = 1;
  std::int32_t four_years = 1;
  std::array<double, 3> position_m{};
  std::array<double, 3> velocity_mps{};
  std::array<double, 3> acceleration_mps2{};
  double clock_correction_s = 0.0;  ///< tau: system time less the satellite's.

  friend bool operator==(const GlonassEphemeris&, const GlonassEphemeris&) = default;
};

/// Everything, from one change of the broadcast to the next.
struct GpsNavigation {
  std::array<std::optional<GpsEphemeris>, 32> ephemerides;  ///< By PRN - 1.
  std::vector<GpsEphemeris> galileo;                        ///< By number.
  std::vector<GpsEphemeris> beidou;                         ///< By number.
  std::vector<GlonassEphemeris> glonass;                    ///< By slot.
  KlobucharParameters ionosphere;
  GpsUtcParameters utc;
};

}  // namespace rigwire
