// One navigation epoch as the sentences of a satellite receiver need it, in SI units and degrees.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace rigwire::protocols::nmea {

/// The values are those of CFG-NMEA.
enum class Version : std::uint8_t { v21 = 0x21, v23 = 0x23, v40 = 0x40, v410 = 0x41, v411 = 0x4B };

/// Satellite systems; the values are those that u-blox receivers number them by (gnssId).
enum class System : std::uint8_t {
  gps = 0,
  sbas = 1,
  galileo = 2,
  beidou = 3,
  qzss = 5,
  glonass = 6,
};

/// A set of systems.
[[nodiscard]] constexpr unsigned system_bit(System system) {
  return 1U << static_cast<unsigned>(system);
}

/// UTC of day, already rounded to hundredths of a second.
struct TimeOfDay {
  int hour = 0;        ///< 0..23
  int minute = 0;      ///< 0..59
  int second = 0;      ///< 0..60
  int hundredths = 0;  ///< 0..99

  friend bool operator==(const TimeOfDay&, const TimeOfDay&) = default;
};

struct Date {
  int year = 1980;  ///< Four digits.
  int month = 1;    ///< 1..12
  int day = 6;      ///< 1..31

  friend bool operator==(const Date&, const Date&) = default;
};

struct SatelliteInView {
  /// Number in the sentences (satellite_numbers.h); 0 is written as an empty field: not identified.
  int number = 0;
  std::optional<int> elevation_deg;
  std::optional<int> azimuth_deg;
  std::optional<int> cn0_dbhz;  ///< Empty when not tracked.
  bool used = false;
  System system = System::gps;
  std::uint8_t signal = 1;             ///< From 4.10 on, 0..15; 0 = unknown, not tracked.
  std::optional<double> residual_m{};  ///< GRS.
  int single_number = 0;               ///< PUBX,03: number in the UBX scheme.
  int locked_s = 0;                    ///< PUBX,03: carrier tracked for so long; 64 and more = 64.
  bool ephemeris = false;              ///< PUBX,03: orbit known.
};

/// Expected errors, one standard deviation.
struct ErrorStatistics {
  double range_m = 0.0;  ///< Root mean square of the ranges' standard deviations.
  double latitude_m = 0.0;
  double longitude_m = 0.0;
  double altitude_m = 0.0;
};

enum class CarrierFix : std::uint8_t { none, floating, fixed };

/// Decimals of position.
enum class Precision : std::uint8_t {
  compatible,  ///< Minutes with four decimals, altitude with one.
  normal,      ///< Five and one.
  high,        ///< Seven and three.
};

struct Epoch {
  std::string_view talker = "GP";  ///< Main talker.
  Version version = Version::v23;
  Precision precision = Precision::normal;
  /// Systems that are switched on (system_bit). 0: one system, that of the talker, whatever the
  /// satellites say; GSV then has the main talker and there is one GSA.
  unsigned systems = 0;
  bool gsv_main_talker = false;  ///< GSV has the main talker, not its system's.
  int maximum_satellites = 0;    ///< In GSV, for each talker; 0 = no limit.

  std::optional<TimeOfDay> time;
  std::optional<Date> date;
  int fix_dimensions = 0;     ///< 0 (no fix), 2 or 3. Without fix the position is not printed.
  bool differential = false;  ///< Quality 2 and mode D instead of 1 and A.
  CarrierFix carrier = CarrierFix::none;     ///< Quality 5 or 4, mode F or R; from version 4.0 on.
  std::optional<double> differential_age_s;  ///< Printed with differential fixes only.
  int station = 0;                           ///< Printed with differential fixes only, 0..9999.
  double latitude_deg = 0.0;                 ///< North positive.
  double longitude_deg = 0.0;                ///< East positive, -180..180.
  double altitude_m = 0.0;                   ///< Above mean sea level.
  double separation_m = 0.0;                 ///< Geoid above ellipsoid.
  double ground_speed_mps = 0.0;
  std::optional<double> course_deg;  ///< Empty while frozen; 0..360.
  double down_velocity_mps = 0.0;    ///< PUBX,00.
  int satellites_used = 0;
  std::optional<double> position_dilution;
  std::optional<double> horizontal_dilution;
  std::optional<double> vertical_dilution;
  std::optional<double> time_dilution;
  std::span<const SatelliteInView> satellites;
  std::optional<ErrorStatistics> errors;  ///< GST, GBS.
  double horizontal_accuracy_m = 0.0;     ///< PUBX,00.
  double vertical_accuracy_m = 0.0;       ///< PUBX,00.
};

}  // namespace rigwire::protocols::nmea
