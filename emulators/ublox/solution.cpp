#include "emulators/ublox/solution.h"

#include <chrono>

#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kCentisecond_ns = 10 * kMillisecond_ns;
constexpr Duration kWeek = 24h * 7;
constexpr std::int32_t kWeeksBroadcast = 1024;

/// Distance to the nearest multiple of `unit`, ties upward: value - result is the multiple.
std::int64_t above(std::int64_t value, std::int64_t unit) {
  const std::int64_t over = value % unit;
  return over * 2 < unit ? over : over - unit;
}

/// What the receiver shows before it knows: the beginning of GPS time.
UtcTime since_epoch(std::uint32_t milliseconds) {
  const auto seconds = static_cast<std::int32_t>(milliseconds / 1000);
  UtcTime utc;
  utc.hour = seconds / 3600 % 24;
  utc.minute = seconds / 60 % 60;
  utc.second = seconds % 60;
  utc.nanosecond = static_cast<std::int32_t>(milliseconds % 1000 / 10 * kCentisecond_ns);
  return utc;
}

}  // namespace

std::array<double, 3> UbloxBase::at(SimTime time) const {
  const double since_s = to_seconds(time - measured);
  std::array<double, 3> place = position_E_m;
  for (std::size_t axis = 0; axis < place.size(); ++axis) {
    place[axis] += velocity_E_mps[axis] * since_s;
  }
  return place;
}

void set_time(UbloxSolution& s, const Calendar& calendar, const UbloxTimeBase& base, SimTime epoch,
              Duration measured_after) {
  const std::int64_t label_rest = above(calendar.gps(epoch).time_of_week_ns, kMillisecond_ns);
  const SimTime label = epoch - Duration{label_rest};
  const SimTime measured = epoch + measured_after;
  const GpsTime gps = calendar.gps(label);

  const std::int32_t past = (gps.week - base.first_week) % kWeeksBroadcast;
  const std::int32_t week = base.first_week + (past < 0 ? past + kWeeksBroadcast : past);
  s.leap_seconds =
      base.leap_error_s + (s.leap_known ? static_cast<std::int32_t>(calendar.leap_seconds(measured))
                                        : base.default_leap_seconds);
  s.week_shift = week - gps.week;
  if (!s.time_known) {
    s.time_of_week_ms = s.since_start_ms;
    s.time_of_week_rest_ns = 0;
    s.week = 0;
    s.utc = since_epoch(s.since_start_ms);
    s.utc_rest_ns = s.utc.nanosecond;
    return;
  }
  s.time_of_week_ms = static_cast<std::uint32_t>(gps.time_of_week_ns / kMillisecond_ns);
  s.time_of_week_rest_ns = static_cast<std::int32_t>((measured - label).count());
  s.week = s.date_known ? week : 0;

  // The instant at which a right receiver would show what this one shows.
  const SimTime shifted = measured + s.week_shift * kWeek;
  const SimTime shown =
      shifted + std::chrono::seconds{calendar.leap_seconds(shifted) - s.leap_seconds};
  const std::int64_t rest = above(calendar.gps(shown).time_of_week_ns, kCentisecond_ns);
  s.utc = calendar.utc(shown - Duration{rest});
  s.utc_rest_ns = static_cast<std::int32_t>(s.utc.nanosecond + rest);
  if (!s.date_known) {
    s.utc.year = UtcTime{}.year;
    s.utc.month = UtcTime{}.month;
    s.utc.day = UtcTime{}.day;
  }
}

}  // namespace rigwire::emulators
