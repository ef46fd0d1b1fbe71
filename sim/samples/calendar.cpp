#include "sim/samples/calendar.h"

#include <array>
#include <charconv>
#include <cstdio>
#include <stdexcept>

namespace rigwire {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kDay = 86'400 * kSecond;
constexpr std::int64_t kWeek = 7 * kDay;

/// Days since 1970-01-01 of a proleptic Gregorian date.
constexpr std::int64_t days_from_civil(int year, int month, int day) {
  return std::chrono::sys_days{std::chrono::year{year} / std::chrono::month{unsigned(month)} /
                               std::chrono::day{unsigned(day)}}
      .time_since_epoch()
      .count();
}

constexpr std::int64_t kGpsEpochDays = 3657;  // 1980-01-06 since 1970-01-01

struct LeapStep {
  int year;
  int month;
  std::int32_t gps_minus_utc;  ///< From the first of that month on.
};

// IERS Bulletin C; GPS - UTC was 0 at the GPS epoch.
constexpr std::array kLeapSteps{
    LeapStep{1981, 7, 1},  LeapStep{1982, 7, 2},  LeapStep{1983, 7, 3},  LeapStep{1985, 7, 4},
    LeapStep{1988, 1, 5},  LeapStep{1990, 1, 6},  LeapStep{1991, 1, 7},  LeapStep{1992, 7, 8},
    LeapStep{1993, 7, 9},  LeapStep{1994, 7, 10}, LeapStep{1996, 1, 11}, LeapStep{1997, 7, 12},
    LeapStep{1999, 1, 13}, LeapStep{2006, 1, 14}, LeapStep{2009, 1, 15}, LeapStep{2012, 7, 16},
    LeapStep{2015, 7, 17}, LeapStep{2017, 1, 18},
};

/// UTC midnight of the step's date, in UTC seconds counted as if every day had 86400 of them.
constexpr std::int64_t step_utc_ns(const LeapStep& step) {
  return (days_from_civil(step.year, step.month, 1) - kGpsEpochDays) * kDay;
}

/// GPS time of the inserted second, the one before each step takes effect.
constexpr auto kInsertedSeconds = [] {
  std::array<std::int64_t, kLeapSteps.size()> begins{};
  for (std::size_t i = 0; i < begins.size(); ++i) {
    begins[i] = step_utc_ns(kLeapSteps[i]) + (kLeapSteps[i].gps_minus_utc - 1) * kSecond;
  }
  return begins;
}();

struct LeapState {
  std::int32_t gps_minus_utc = 0;
  bool inserted_second = false;  ///< Within second 60.
};

LeapState leap_state(std::int64_t gps_ns) {
  // The last of them that has begun; most instants are after all of them.
  std::size_t begun = kInsertedSeconds.size();
  while (begun > 0 && gps_ns < kInsertedSeconds[begun - 1]) {
    --begun;
  }
  if (begun == 0) {
    return {};
  }
  LeapState state;
  state.inserted_second = gps_ns < kInsertedSeconds[begun - 1] + kSecond;
  state.gps_minus_utc = kLeapSteps[begun - 1].gps_minus_utc - (state.inserted_second ? 1 : 0);
  return state;
}

bool leap_second_follows(std::int64_t day_start_ns) {
  for (const auto& step : kLeapSteps) {
    if (step_utc_ns(step) == day_start_ns + kDay) {
      return true;
    }
  }
  return false;
}

[[noreturn]] void reject(const std::string& what) {
  throw std::invalid_argument(what);
}

}  // namespace

Calendar::Calendar(const UtcTime& start) : start_gps_ns_(0) {
  const std::chrono::year_month_day date{std::chrono::year{start.year},
                                         std::chrono::month{static_cast<unsigned>(start.month)},
                                         std::chrono::day{static_cast<unsigned>(start.day)}};
  const bool time_ok = start.hour >= 0 && start.hour < 24 && start.minute >= 0 &&
                       start.minute < 60 && start.second >= 0 && start.second <= 60 &&
                       start.nanosecond >= 0 && start.nanosecond < kSecond;
  if (!date.ok() || !time_ok) {
    reject("no such UTC time: " + format_utc(start));
  }
  const std::int64_t day_ns =
      (days_from_civil(start.year, start.month, start.day) - kGpsEpochDays) * kDay;
  if (day_ns < 0 || start.year > 2099) {
    reject("UTC time " + format_utc(start) + " is outside 1980-01-06 .. 2099-12-31");
  }
  if (start.second == 60 &&
      !(start.hour == 23 && start.minute == 59 && leap_second_follows(day_ns))) {
    reject("no leap second was inserted at " + format_utc(start));
  }
  const std::int64_t utc_ns = day_ns +
                              ((start.hour * 60LL + start.minute) * 60 + start.second) * kSecond +
                              start.nanosecond;
  // Leap seconds in force on that day: the last step whose date is not later than the day.
  std::int32_t leap = 0;
  for (const auto& step : kLeapSteps) {
    if (step_utc_ns(step) <= day_ns) {
      leap = step.gps_minus_utc;
    }
  }
  start_gps_ns_ = utc_ns + leap * kSecond;
}

GpsTime Calendar::gps(SimTime instant) const {
  const std::int64_t ns = start_gps_ns_ + instant.time_since_epoch().count();
  return {static_cast<std::int32_t>(ns / kWeek), ns % kWeek};
}

std::int32_t Calendar::leap_seconds(SimTime instant) const {
  return leap_state(start_gps_ns_ + instant.time_since_epoch().count()).gps_minus_utc;
}

UtcTime Calendar::utc(SimTime instant) const {
  const std::int64_t gps_ns = start_gps_ns_ + instant.time_since_epoch().count();
  const LeapState leap = leap_state(gps_ns);
  std::int64_t utc_ns = gps_ns - leap.gps_minus_utc * kSecond;
  if (leap.inserted_second) {
    utc_ns -= kSecond;  // printed as second 60 of the minute before
  }
  const std::int64_t days = utc_ns / kDay;
  const std::int64_t of_day = utc_ns % kDay;
  const std::chrono::year_month_day date{
      std::chrono::sys_days{std::chrono::days{days + kGpsEpochDays}}};
  UtcTime time;
  time.year = static_cast<int>(date.year());
  time.month = static_cast<std::int32_t>(static_cast<unsigned>(date.month()));
  time.day = static_cast<std::int32_t>(static_cast<unsigned>(date.day()));
  const std::int64_t seconds = of_day / kSecond;
  time.hour = static_cast<std::int32_t>(seconds / 3600);
  time.minute = static_cast<std::int32_t>(seconds / 60 % 60);
  time.second = static_cast<std::int32_t>(seconds % 60) + (leap.inserted_second ? 1 : 0);
  time.nanosecond = static_cast<std::int32_t>(of_day % kSecond);
  return time;
}

std::int64_t Calendar::nanoseconds_of_hour(SimTime instant) const {
  const UtcTime time = utc(instant);
  return (time.minute * 60LL + time.second) * kSecond + time.nanosecond;
}

SimTime Calendar::align_to_gps(SimTime instant, Duration period) const {
  const std::int64_t of_week = gps(instant).time_of_week_ns;
  const std::int64_t over = of_week % period.count();
  return over == 0 ? instant : instant + Duration{period.count() - over};
}

UtcTime parse_utc(std::string_view text) {
  const auto complain = [&]() {
    reject("'" + std::string(text) + "' is not a UTC time like 2026-06-01T08:00:00Z");
  };
  const auto number = [&](std::size_t at, std::size_t digits) {
    std::int32_t value = 0;
    const char* begin = text.data() + at;
    const auto [end, error] = std::from_chars(begin, begin + digits, value);
    if (error != std::errc{} || end != begin + digits || *begin == '-') {
      complain();
    }
    return value;
  };
  if (text.size() < 20 || text.back() != 'Z' || text[4] != '-' || text[7] != '-' ||
      text[10] != 'T' || text[13] != ':' || text[16] != ':') {
    complain();
  }
  UtcTime time;
  time.year = number(0, 4);
  time.month = number(5, 2);
  time.day = number(8, 2);
  time.hour = number(11, 2);
  time.minute = number(14, 2);
  time.second = number(17, 2);
  if (text.size() > 20) {
    const std::size_t digits = text.size() - 21;
    if (text[19] != '.' || digits == 0 || digits > 9) {
      complain();
    }
    time.nanosecond = number(20, digits);
    for (std::size_t i = digits; i < 9; ++i) {
      time.nanosecond *= 10;
    }
  }
  return time;
}

std::string format_utc(const UtcTime& time) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02d-%02dT%02d:%02d:%02d", time.year, time.month,
                time.day, time.hour, time.minute, time.second);
  std::string result(text.data());
  if (time.nanosecond != 0) {
    std::snprintf(text.data(), text.size(), ".%09d", time.nanosecond);
    result += text.data();
    result.erase(result.find_last_not_of('0') + 1);
  }
  return result + "Z";
}

std::chrono::nanoseconds unix_time(const UtcTime& time) {
  using namespace std::chrono;
  const sys_days day =
      year{time.year} / static_cast<unsigned>(time.month) / static_cast<unsigned>(time.day);
  return day.time_since_epoch() + hours{time.hour} + minutes{time.minute} + seconds{time.second} +
         nanoseconds{time.nanosecond};
}

}  // namespace rigwire
