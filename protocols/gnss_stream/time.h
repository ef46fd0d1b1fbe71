// The time in the messages of a satellite receiver's log, NMEA and UBX together.
//
// NMEA counts the time of day in UTC, UBX the time of week in GPS time, which is ahead of UTC by
// the leap seconds; some messages give the date. StreamClock puts all of them on one axis that
// never turns over: the end of a day, of a week and a leap second are as long as they are.
//
// Sources: NMEA 0183 sentences as u-blox UBX-13003221 R28 section 31 lists them; UBX as its section
// 32 does; leap seconds: IERS Bulletin C.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "protocols/nmea/sentence.h"
#include "protocols/ubx/frame.h"

namespace rigwire::protocols::gnss_stream {

/// The time that a message gives for its epoch; at least one of the first two.
struct MessageTime {
  std::optional<std::int64_t> of_day_ns;   ///< UTC; from 86 400 s on within a leap second.
  std::optional<std::int64_t> of_week_ns;  ///< GPS time.
  std::optional<std::int64_t> day;         ///< UTC, days since 1970-01-01.
  std::optional<int> leap_seconds;         ///< GPS time minus UTC.
  bool doubtful = false;                   ///< The message says that its receiver has no fix.
  std::string_view by;                     ///< Name of the message, where it gives a date.
};

/// Returns the time in GGA, RMC, GLL, GNS, GBS, GST, GRS, ZDA and PUBX,00 and 04; nothing where the
/// sentence has none, or one that is no time of day.
[[nodiscard]] std::optional<MessageTime> time_of(const nmea::SentenceView& sentence);
/// Returns the time in the messages of class NAV that have iTOW, and in RXM-RAWX; nothing for all
/// others, and for a time of week that is none.
[[nodiscard]] std::optional<MessageTime> time_of(const ubx::FrameView& frame);

/// Returns GPS time minus UTC on a day, days since 1970-01-01; that of 1999 before it.
[[nodiscard]] int leap_seconds_on(std::int64_t day);

/// Finds GPS time minus UTC for a stream: as a message gives it, from a date in it, or from the
/// difference between neighbours that count differently.
class LeapSeconds {
 public:
  void take(const MessageTime& time);
  /// Returns 18, that of 2017 and later, where nothing in the stream gives it.
  [[nodiscard]] int value() const;

 private:
  std::optional<int> told_;
  std::optional<int> by_date_;
  std::optional<int> by_neighbours_;
  std::optional<MessageTime> last_;
};

/// Puts the times of a stream's messages, in its order, on one axis.
class StreamClock {
 public:
  explicit StreamClock(int leap_seconds) : leap_seconds_(leap_seconds) {}

  /// Returns the instant of the message's epoch in ns. The axis begins with the first message, at
  /// its time of day. A time up to an hour before the last one is taken for a message that is out
  /// of order, else for the next day or week.
  std::int64_t take(const MessageTime& time);

 private:
  int leap_seconds_;
  bool begun_ = false;
  std::int64_t now_ns_ = 0;
  /// Time of day of the last message, or extrapolated from it.
  std::int64_t of_day_ns_ = 0;
  /// Time of week of the last message, or extrapolated; empty until a message reports it.
  std::optional<std::int64_t> of_week_ns_;
  /// UTC since 1970 at the last message, or extrapolated; empty until a message reports it.
  std::optional<std::int64_t> date_ns_;
};

}  // namespace rigwire::protocols::gnss_stream
