// Calendar time, derived from simulation time in this one place.
//
// A Calendar is fixed to the UTC date at which the simulation starts. GPS time runs without leap
// seconds from 1980-01-06 00:00:00 UTC; UTC is GPS time less the leap seconds of the built-in table
// (IERS Bulletin C, 1981-07-01 .. 2017-01-01; none announced since). During a leap second `second`
// is 60.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "sim/samples/time.h"

namespace rigwire {

/// GPS week (not rolled over) and time of week.
struct GpsTime {
  std::int32_t week = 0;             ///< Since 1980-01-06.
  std::int64_t time_of_week_ns = 0;  ///< [0, 604800e9).

  friend bool operator==(const GpsTime&, const GpsTime&) = default;
};

/// Broken-down UTC, proleptic Gregorian.
struct UtcTime {
  std::int32_t year = 1980;
  std::int32_t month = 1;       ///< 1..12
  std::int32_t day = 6;         ///< 1..31
  std::int32_t hour = 0;        ///< 0..23
  std::int32_t minute = 0;      ///< 0..59
  std::int32_t second = 0;      ///< 0..59, 60 in a leap second
  std::int32_t nanosecond = 0;  ///< 0..999 999 999

  friend bool operator==(const UtcTime&, const UtcTime&) = default;
};

class Calendar {
 public:
  /// Throws std::invalid_argument when `start` is not a date, or is outside 1980-01-06 ..
  /// 2099-12-31.
  explicit Calendar(const UtcTime& start);

  [[nodiscard]] GpsTime gps(SimTime instant) const;
  [[nodiscard]] UtcTime utc(SimTime instant) const;
  /// GPS time minus UTC at `instant`, whole seconds.
  [[nodiscard]] std::int32_t leap_seconds(SimTime instant) const;
  /// Nanoseconds since the last full UTC hour (the Velodyne clock), 0 .. 3600e9 (3601e9 in a leap
  /// hour).
  [[nodiscard]] std::int64_t nanoseconds_of_hour(SimTime instant) const;
  /// The first instant at or after `instant` that is a multiple of `period` in GPS time of week.
  [[nodiscard]] SimTime align_to_gps(SimTime instant, Duration period) const;

 private:
  std::int64_t start_gps_ns_;  ///< Nanoseconds since 1980-01-06 00:00:00 at simulation start.
};

/// "2026-06-01T08:00:00Z", with up to nine decimals of the second; throws std::invalid_argument.
[[nodiscard]] UtcTime parse_utc(std::string_view text);
[[nodiscard]] std::string format_utc(const UtcTime& time);

/// Returns the time since 1970-01-01 00:00:00 UTC without leap seconds, as computers count.
[[nodiscard]] std::chrono::nanoseconds unix_time(const UtcTime& time);

}  // namespace rigwire
