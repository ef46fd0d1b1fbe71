#include "dig_cycle/sensor_watch.h"

#include <array>
#include <vector>

namespace rigwire::dig_cycle {
namespace {

using namespace std::chrono_literals;

std::vector<field::SilenceWatch::Device> devices() {
  std::vector<field::SilenceWatch::Device> devices;
  for (std::size_t i = 0; i < kSensors; ++i) {
    const auto sensor = static_cast<Sensor>(i);
    devices.push_back({name(sensor), SensorWatch::limit(sensor)});
  }
  return devices;
}

}  // namespace

std::string_view name(Sensor sensor) {
  constexpr std::array<std::string_view, kSensors> kNames{
      "gnss", "lidar", "imu_chassis", "imu_boom", "imu_stick", "imu_bucket", "valves"};
  return kNames[static_cast<std::size_t>(sensor)];
}

SensorWatch::SensorWatch() : watch_(devices()) {}

std::chrono::milliseconds SensorWatch::limit(Sensor sensor) {
  return sensor == Sensor::gnss ? 3000ms : 500ms;
}

std::optional<Sensor> SensorWatch::silent(Instant now) const {
  const auto device = watch_.silent(now);
  return device ? std::optional(static_cast<Sensor>(*device)) : std::nullopt;
}

}  // namespace rigwire::dig_cycle
