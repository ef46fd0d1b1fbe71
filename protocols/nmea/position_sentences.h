// RMC, VTG, GGA, GSA, GSV, GLL, ZDA and TXT exactly as a u-blox 7 prints them (NMEA 2.1 and 2.3),
// and a strict reader of RMC and GGA.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 31.2 "Standard Messages";
// decimals, empty fields and padding from recordings of a NEO-7P: what is not known stays empty,
// the dilutions are then 99.99, the last GSV page is not padded.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocols/nmea/sentence.h"
#include "protocols/result.h"

namespace rigwire::protocols::nmea {

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
  int number = 0;  ///< GPS 1..32, SBAS 33..64, GLONASS 65..96.
  std::optional<int> elevation_deg;
  std::optional<int> azimuth_deg;
  std::optional<int> cn0_dbhz;  ///< Empty when not tracked.
  bool used = false;
};

/// One navigation epoch as the sentences need it.
struct Epoch {
  std::string_view talker = "GP";
  bool with_mode = true;  ///< The position mode field of NMEA 2.3 in RMC, VTG and GLL.
  std::optional<TimeOfDay> time;
  std::optional<Date> date;
  int fix_dimensions = 0;      ///< 0 (no fix), 2 or 3. Without fix the position is not printed.
  bool differential = false;   ///< Quality 2 and mode D instead of 1 and A.
  double latitude_deg = 0.0;   ///< North positive.
  double longitude_deg = 0.0;  ///< East positive, -180..180.
  double altitude_m = 0.0;     ///< Above mean sea level.
  double separation_m = 0.0;   ///< Geoid above ellipsoid.
  double ground_speed_mps = 0.0;
  std::optional<double> course_deg;  ///< Empty while frozen; 0..360.
  int satellites_used = 0;
  std::optional<double> position_dilution;
  std::optional<double> horizontal_dilution;
  std::optional<double> vertical_dilution;
  std::span<const SatelliteInView> satellites;  ///< GSV prints at most 20 of them.
};

[[nodiscard]] Sentence write_rmc(const Epoch& epoch);
[[nodiscard]] Sentence write_vtg(const Epoch& epoch);
[[nodiscard]] Sentence write_gga(const Epoch& epoch);
[[nodiscard]] Sentence write_gsa(const Epoch& epoch);
[[nodiscard]] Sentence write_gll(const Epoch& epoch);
[[nodiscard]] Sentence write_zda(const Epoch& epoch);

/// GSV comes in pages of four satellites: 1..5 of them.
[[nodiscard]] int gsv_pages(const Epoch& epoch);
/// `page` counts from 1.
[[nodiscard]] Sentence write_gsv(const Epoch& epoch, int page);

enum class TextKind : std::uint8_t { error = 0, warning = 1, notice = 2, user = 7 };
/// TXT in one part ("01,01").
[[nodiscard]] Sentence write_txt(std::string_view talker, TextKind kind, std::string_view text);

/// What RMC says. Position and speed are there only when `valid`.
struct Rmc {
  bool valid = false;
  std::optional<TimeOfDay> time;
  std::optional<Date> date;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ground_speed_mps = 0.0;
  std::optional<double> course_deg;
};

/// What GGA says. Position and altitude are there only when `quality` is not 0.
struct Gga {
  int quality = 0;
  std::optional<TimeOfDay> time;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;    ///< Above mean sea level.
  double separation_m = 0.0;  ///< Geoid above ellipsoid.
  int satellites_used = 0;
  std::optional<double> horizontal_dilution;
};

/// Malformed when it is another sentence, a field that must be there is not, a number has strange
/// characters, or a value is out of its range. consumed() is 1: one sentence.
[[nodiscard]] Decoded<Rmc> read_rmc(const SentenceView& sentence);
[[nodiscard]] Decoded<Gga> read_gga(const SentenceView& sentence);

}  // namespace rigwire::protocols::nmea
