// Lidar sensors from their configuration: the one place that knows every way of simulating one.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "hil/world/lidar_sensor_configuration.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::hil {

/// What the device says of its head.
struct LidarHead {
  LidarPattern pattern;
  SamplePlan plan;
  LidarCommand command;
};

/// Noise depends on (seed, name) only. Throws std::invalid_argument as the sensors' constructors
/// do.
[[nodiscard]] std::unique_ptr<sim::LidarSensor> make_lidar_sensor(
    const LidarSensorConfiguration& configuration, const LidarHead& head, std::uint64_t seed,
    std::string_view name);

}  // namespace rigwire::hil
