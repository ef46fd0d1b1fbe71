// A sensor of any model, fed with firings on its own clock, and what it put on the wire.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "emulators/velodyne/velodyne_lidar.h"
#include "fault_period.h"
#include "recorder.h"

namespace rigwire::emulators {

/// The bytes of a data packet, read by hand.
struct RawPacket {
  const std::vector<std::uint8_t>& bytes;
  [[nodiscard]] int u16(std::size_t at) const { return bytes[at] | bytes[at + 1] << 8; }
  [[nodiscard]] int flag(std::size_t block) const { return u16(100 * block); }
  [[nodiscard]] int azimuth(std::size_t block) const { return u16(100 * block + 2); }
  [[nodiscard]] int distance(std::size_t block, std::size_t channel) const {
    return u16(100 * block + 4 + 3 * channel);
  }
  [[nodiscard]] int reflectivity(std::size_t block, std::size_t channel) const {
    return bytes[100 * block + 6 + 3 * channel];
  }
  [[nodiscard]] std::int64_t timestamp_us() const {
    return u16(1200) + (static_cast<std::int64_t>(u16(1202)) << 16);
  }
};

class VelodyneFixture : public testing::Test {
 protected:
  Calendar calendar{parse_utc("2026-06-01T08:59:50Z")};
  test::ByteRecorder data;
  test::ByteRecorder position;
  std::int64_t next_firing = 0;
  double azimuth_rad = 0.0;
  /// Fills the echoes of a bank; by default every laser sees a grey wall at 10 m.
  std::function<void(LidarFiring&)> see = [](LidarFiring& bank) {
    bank.strongest.fill({10.0F, 0.5F});
  };

  /// One firing of all banks, with a rotor that follows the command at once.
  void fire(VelodyneLidar& lidar) {
    const SamplePlan plan = lidar.sample_plan();
    const SimTime time = plan.first + next_firing++ * plan.period;
    const double rate = lidar.command().rotor_rate_radps;
    azimuth_rad = std::fmod(azimuth_rad + rate * to_seconds(plan.period), 2.0 * std::numbers::pi);
    for (std::size_t b = 0; b < lidar.pattern().banks(); ++b) {
      LidarFiring bank;
      bank.time = time;
      bank.rotor_azimuth_rad = azimuth_rad;
      bank.rotor_rate_radps = rate;
      bank.first_laser = b * kBankLasers;
      see(bank);
      lidar.update(bank);
    }
  }
  void fire(VelodyneLidar& lidar, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
      fire(lidar);
    }
  }
  /// Fires until `end`, less one firing period.
  void fire_until(VelodyneLidar& lidar, SimTime end) {
    while (lidar.sample_plan().first + next_firing * lidar.sample_plan().period < end) {
      fire(lidar);
    }
  }
  /// Lets the firings of a stretch of time pass unseen.
  void skip_to(const VelodyneLidar& lidar, SimTime time) {
    const SamplePlan plan = lidar.sample_plan();
    next_firing = (time - plan.first) / plan.period + 1;
  }
  [[nodiscard]] RawPacket packet(std::size_t index) const { return {data.sent.at(index).bytes}; }
  [[nodiscard]] protocols::velodyne::PositionPacket position_packet(std::size_t index) const {
    return *protocols::velodyne::decode_position_packet(position.sent.at(index).bytes);
  }
};

}  // namespace rigwire::emulators
