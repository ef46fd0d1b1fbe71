#include "dig_cycle/sensor_watch.h"

namespace rigwire::dig_cycle {

using namespace std::chrono_literals;

std::string_view name(Sensor sensor) {
  constexpr std::array<std::string_view, kSensors> kNames{
      "gnss", "lidar", "imu_chassis", "imu_boom", "imu_stick", "imu_bucket", "valves"};
  return kNames[static_cast<std::size_t>(sensor)];
}

std::chrono::milliseconds SensorWatch::limit(Sensor sensor) {
  return sensor == Sensor::gnss ? 3000ms : 500ms;
}

void SensorWatch::heard(Sensor sensor, Instant now) {
  last_[static_cast<std::size_t>(sensor)] = now;
}

bool SensorWatch::alive(std::size_t sensor, Instant now) const {
  return last_[sensor] && now - *last_[sensor] <= limit(static_cast<Sensor>(sensor));
}

std::optional<Sensor> SensorWatch::silent(Instant now) const {
  for (std::size_t sensor = 0; sensor < kSensors; ++sensor) {
    if (last_[sensor] && !alive(sensor, now)) {
      return static_cast<Sensor>(sensor);
    }
  }
  return std::nullopt;
}

bool SensorWatch::all_alive(Instant now) const {
  for (std::size_t sensor = 0; sensor < kSensors; ++sensor) {
    if (!alive(sensor, now)) {
      return false;
    }
  }
  return true;
}

std::string SensorWatch::absent(Instant now) const {
  std::string names;
  for (std::size_t sensor = 0; sensor < kSensors; ++sensor) {
    if (!alive(sensor, now)) {
      names += names.empty() ? "" : ", ";
      names += name(static_cast<Sensor>(sensor));
    }
  }
  return names;
}

}  // namespace rigwire::dig_cycle
