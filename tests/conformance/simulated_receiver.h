// A receiver run in simulated time, as fast as the machine allows: what it said, byte by byte.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>

#include "emulators/ublox/receiver.h"
#include "recorder.h"
#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::test {

/// What the receiver sees at an instant that it planned.
using Sky = std::function<GnssSample(SimTime)>;

/// A machine that drives north-east up a slope, seen without error by eleven satellites.
inline GnssSample driving_machine(SimTime time) {
  const double t = to_seconds(time);
  GnssSample sample;
  sample.time = time;
  sample.fix = GnssFix::three_d;
  sample.latitude_deg = 49.42 + 2e-5 * t;
  sample.longitude_deg = 7.75 + 3e-5 * t;
  sample.ellipsoid_height_m = 300.0 + 0.5 * t;
  sample.geoid_separation_m = 48.0;
  sample.velocity_ned_mps = {2.226, 2.175, -0.5};
  sample.horizontal_accuracy_m = 2.5;
  sample.vertical_accuracy_m = 4.0;
  sample.speed_accuracy_mps = 0.1;
  sample.time_accuracy_s = 20e-9;
  sample.horizontal_dilution = 1.02;
  sample.vertical_dilution = 1.92;
  sample.position_dilution = 1.84;
  sample.time_dilution = 0.9;
  for (std::uint8_t prn = 1; prn <= 11; ++prn) {
    sample.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 35.0 + prn, true, true});
  }
  return sample;
}

struct Recording {
  std::string bytes;
  emulators::UbloxCounters counters;
};

/// Powers a receiver on at the calendar's start and lets it live for `span`.
[[nodiscard]] inline Recording run_receiver(const emulators::UbloxSettings& settings,
                                            const Calendar& calendar, const Sky& sky,
                                            Duration span) {
  test::ByteRecorder sink;
  emulators::UbloxReceiver receiver(settings, calendar, sink);
  receiver.set_client(kStart, {true, settings.baud});
  SimTime now = kStart;
  SimTime sampled = kStart;
  const SimTime end = kStart + span;
  while (now < end) {
    const SimTime planned = receiver.sample_plan().next_after(sampled);
    now = std::max(now, std::min({end, planned, receiver.next_event()}));
    receiver.advance(now);
    if (planned <= now) {
      sampled = planned;
      receiver.update(sky(planned));
    }
  }
  return {sink.text(), receiver.counters()};
}

}  // namespace rigwire::test
