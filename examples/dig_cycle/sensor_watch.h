// The sensors of the dig cycle, and how long each may be silent.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "field/silence_watch.h"

namespace rigwire::dig_cycle {

enum class Sensor : std::size_t {
  gnss,
  lidar,
  imu_chassis,
  imu_boom,
  imu_stick,
  imu_bucket,
  valves,
};
inline constexpr std::size_t kSensors = 7;
[[nodiscard]] std::string_view name(Sensor sensor);

/// The four inertial sensors follow each other in the order of Link.
[[nodiscard]] constexpr Sensor imu_of(std::size_t link) {
  return static_cast<Sensor>(static_cast<std::size_t>(Sensor::imu_chassis) + link);
}

class SensorWatch {
 public:
  using Instant = field::SilenceWatch::Instant;

  SensorWatch();

  /// Silence allowed: GNSS 3 s, lidar, IMU and valve driver 0.5 s. The last three send far more
  /// often; but on a busy machine the system has been seen to hold back the bytes of a
  /// pseudo-terminal for a quarter of a second.
  static std::chrono::milliseconds limit(Sensor sensor);

  void heard(Sensor sensor, Instant now) { watch_.heard(static_cast<std::size_t>(sensor), now); }
  /// The first sensor that has sent data and has been silent for longer than its limit.
  [[nodiscard]] std::optional<Sensor> silent(Instant now) const;
  /// Every sensor has sent data and none is silent.
  [[nodiscard]] bool all_alive(Instant now) const { return watch_.all_alive(now); }
  /// Names of those that have never sent data or are silent, comma-separated.
  [[nodiscard]] std::string absent(Instant now) const { return watch_.absent(now); }

 private:
  field::SilenceWatch watch_;
};

}  // namespace rigwire::dig_cycle
