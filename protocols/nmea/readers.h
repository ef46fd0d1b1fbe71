// Strict readers of standard sentences.
//
// Malformed when it is another sentence, a field that must be there is not, a number has strange
// characters, or a value is out of its range. consumed() is 1: one sentence. Fields that versions
// add at the end are taken and ignored, but for system and signal.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocols/nmea/epoch.h"
#include "protocols/nmea/sentence.h"
#include "protocols/result.h"

namespace rigwire::protocols::nmea {

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

/// What GLL says. The position is there only when `valid`.
struct Gll {
  bool valid = false;
  std::optional<TimeOfDay> time;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// What VTG says; all empty without fix.
struct Vtg {
  std::optional<double> course_deg;
  std::optional<double> ground_speed_mps;  ///< From km/h.
};

struct Zda {
  std::optional<TimeOfDay> time;
  std::optional<Date> date;
};

/// Dilutions of 99.99 are empty.
struct Gsa {
  int mode = 1;  ///< 1 no fix, 2, 3 dimensions.
  std::array<int, 12> used{};
  std::size_t used_count = 0;
  std::optional<double> position_dilution;
  std::optional<double> horizontal_dilution;
  std::optional<double> vertical_dilution;
  std::optional<int> system;  ///< From version 4.10 on.
};

struct GsvSatellite {
  int number = 0;  ///< 0 when the field is empty.
  std::optional<int> elevation_deg;
  std::optional<int> azimuth_deg;
  std::optional<int> cn0_dbhz;
};

/// One page of GSV.
struct Gsv {
  int pages = 1;
  int page = 1;
  int in_view = 0;
  std::array<GsvSatellite, 4> satellites{};
  std::size_t satellite_count = 0;
  std::optional<int> signal;  ///< From version 4.10 on.
};

/// Standard deviations, empty without fix.
struct Gst {
  std::optional<TimeOfDay> time;
  std::optional<double> range_m;
  std::optional<double> latitude_m;
  std::optional<double> longitude_m;
  std::optional<double> altitude_m;
};

[[nodiscard]] Decoded<Rmc> read_rmc(const SentenceView& sentence);
[[nodiscard]] Decoded<Gga> read_gga(const SentenceView& sentence);
[[nodiscard]] Decoded<Gll> read_gll(const SentenceView& sentence);
[[nodiscard]] Decoded<Vtg> read_vtg(const SentenceView& sentence);
[[nodiscard]] Decoded<Zda> read_zda(const SentenceView& sentence);
[[nodiscard]] Decoded<Gsa> read_gsa(const SentenceView& sentence);
[[nodiscard]] Decoded<Gsv> read_gsv(const SentenceView& sentence);
[[nodiscard]] Decoded<Gst> read_gst(const SentenceView& sentence);

}  // namespace rigwire::protocols::nmea
