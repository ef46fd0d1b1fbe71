// An emulated inclination sensor under test: its ticks, its one constant sample, and what it sends.
#pragma once

#include <cstdint>

#include "emulators/openimu/openimu335ri.h"
#include "recorder.h"

namespace rigwire::emulators {

constexpr double kGravity = 9.80665;

/// A sample of a housing that stands level and still.
inline ImuSample level(SimTime time = kStart) {
  return {time, {0.0, 0.0, kGravity}, {0.0, 0.0, 0.0}, 25.0};
}

inline OpenImuSettings settings_with(std::uint32_t serial,
                                     OpenImuVariant variant = OpenImuVariant::openimu335ri) {
  OpenImuSettings settings;
  settings.serial = serial;
  settings.variant = variant;
  return settings;
}

/// A device with its ticks, fed with one constant sample.
struct OpenImuRig {
  explicit OpenImuRig(const OpenImuSettings& settings = settings_with(0x12341))
      : imu(settings, memory, output) {}

  void run(Duration span, ImuSample sample = level()) {
    for (const SimTime end = now + span; now < end; now += OpenImu::kTick) {
      sample.time = now;
      imu.update(sample);
    }
  }
  void receive(const protocols::can::Frame& frame) { imu.receive(now, frame); }

  VolatileMemory memory;
  test::FrameRecorder output;
  OpenImu imu;
  SimTime now = kStart;
};

}  // namespace rigwire::emulators
