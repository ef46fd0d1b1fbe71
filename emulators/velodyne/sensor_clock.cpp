#include "emulators/velodyne/sensor_clock.h"

#include <cmath>

#include "fields/constants.h"

namespace rigwire::emulators {

void SensorClock::set(SimTime now, std::int64_t hour_ns) {
  set_at_ = now;
  set_to_ns_ = hour_ns % kHour_ns;
}

void SensorClock::set_to_whole_second(SimTime pulse) {
  set(pulse, (hour_ns(pulse) + kSecond_ns / 2) / kSecond_ns * kSecond_ns);
}

std::int64_t SensorClock::hour_ns(SimTime instant) const {
  const std::int64_t elapsed = (instant - set_at_).count();
  // Set value + elapsed (1 + drift), modulo an hour.
  const std::int64_t gained = std::llround(static_cast<double>(elapsed) * drift_);
  return ((set_to_ns_ + elapsed + gained) % kHour_ns + kHour_ns) % kHour_ns;
}

}  // namespace rigwire::emulators
