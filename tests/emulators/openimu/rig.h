// An emulated inclination sensor under test: its ticks, its one constant sample, and what it sends.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "emulators/openimu/openimu335ri.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

constexpr double kGravity = 9.80665;

/// Records the frames that a node sends, and holds that they are due in order.
struct OpenImuBus final : FrameOutput {
  void send(SimTime due, const protocols::can::Frame& frame) override {
    EXPECT_GE(due, last);
    last = due;
    frames.emplace_back(due, frame);
  }
  /// Frames of one group, oldest first.
  [[nodiscard]] std::vector<protocols::can::Frame> of(std::uint32_t pgn) const {
    std::vector<protocols::can::Frame> result;
    for (const auto& [due, frame] : frames) {
      if (protocols::j1939::unpack(frame.id).pgn == pgn) {
        result.push_back(frame);
      }
    }
    return result;
  }
  SimTime last = kStart;
  std::vector<std::pair<SimTime, protocols::can::Frame>> frames;
};

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
  OpenImuBus output;
  OpenImu imu;
  SimTime now = kStart;
};

}  // namespace rigwire::emulators
