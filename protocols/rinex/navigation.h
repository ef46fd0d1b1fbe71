// RINEX navigation files: broadcast ephemerides of GPS as text.
//
// Source: RINEX 2.11 (W. Gurtner, 2007) tables A3 and A4; RINEX 3.04 (IGS, 2018) sections 5.2, 6.8,
// tables A5 and A6. Read are versions 2.x (GPS files) and 3.x (any mix of systems); written
// is 3.04.
//
// Decimals: the format has 13 significant digits, so a value read is within 5e-13 of itself of the
// broadcast one, closer than half a step of the message; gps::quantised() makes it exact again.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/gps/ephemeris.h"
#include "protocols/gps/page.h"

namespace rigwire::protocols::rinex {

struct NavigationRecord {
  gps::Ephemeris ephemeris;
  /// Time of week of the hand-over word, counted from the ephemeris' week; may lie outside of it.
  double transmission_time_s = 0.0;

  friend bool operator==(const NavigationRecord&, const NavigationRecord&) = default;
};

struct NavigationFile {
  double version = 3.04;
  std::vector<NavigationRecord> records;  ///< In the file's order.
  /// Klobuchar's coefficients, GPS to UTC and leap seconds, as far as the header has them.
  gps::IonosphereUtc ionosphere_utc;
  bool has_ionosphere = false;
  bool has_utc = false;
  bool has_leap_seconds = false;
  std::size_t skipped_records = 0;       ///< Records of other systems.
  std::size_t skipped_header_lines = 0;  ///< Header lines with unknown labels, except comments.
};

/// Throws std::invalid_argument "name:line: ..." for files that are cut, of another type or
/// version, or have a field that is not what the format allows.
[[nodiscard]] NavigationFile read_navigation(std::string_view text, std::string_view name);

/// Program and person that made a file, and the date, for its header.
struct Origin {
  std::string program = "rigwire";
  std::string run_by;
  std::string date;  ///< "20240601 120000 UTC".
};

/// The whole text. `version` and the counts of skipped things are not used.
[[nodiscard]] std::string write_navigation(const NavigationFile& file, const Origin& origin);

}  // namespace rigwire::protocols::rinex
