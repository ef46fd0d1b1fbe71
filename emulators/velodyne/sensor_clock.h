// The sensor's counter of time past the hour: a crystal that runs from power-up and is set by
// pulses and sentences.
//
// Integer nanoseconds; the crystal's error is applied to the time since the last setting, so that
// nothing accumulates. It counts 3600 s and then 0; the leap second at the end of an hour is
// shown as a second 0 that occurs twice.
//
// Source: VLP-16 user's manual 63-9243 Rev. D, "GPS, pulse per second and NMEA sentence" (what sets
// the counter, and what it does without).
#pragma once

#include <cstdint>

#include "fields/constants.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

class SensorClock {
 public:
  /// `drift_ppm` positive: the counter gains on true time.
  explicit SensorClock(double drift_ppm) : drift_(drift_ppm * 1e-6) {}

  /// The counter begins at zero.
  void power_up(SimTime now) { set(now, 0); }
  /// Sets the whole counter, which then shows `hour_ns` modulo an hour.
  void set(SimTime now, std::int64_t hour_ns);
  /// A pulse without a sentence: to the nearest whole second; minutes stay.
  void set_to_whole_second(SimTime pulse);

  /// Nanoseconds past the hour that the counter shows, [0, 3600e9). Precondition: not before the
  /// last setting by more than an hour.
  [[nodiscard]] std::int64_t hour_ns(SimTime instant) const;

 private:
  double drift_;
  SimTime set_at_ = kStart;
  std::int64_t set_to_ns_ = 0;
};

}  // namespace rigwire::emulators
