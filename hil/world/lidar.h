// Lidars in the simulated world, from their configuration: the one place that knows every way of
// simulating one. A lidar casts the slice as a whole, every laser at its own time.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "fields/rules.h"
#include "hil/world/world_sensor.h"
#include "sim/lidar/depth_image_parameters.h"
#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/lidar/rotor.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::hil {

enum class LidarMethod {
  rays,         ///< sim::SpinningLidar
  depth_image,  ///< sim::DepthImageLidar
};

struct LidarSensorConfiguration {
  LidarMethod method = LidarMethod::rays;
  sim::SpinningLidarParameters beam;
  sim::DepthImageParameters images;  ///< Means nothing with LidarMethod::rays.
  sim::RotorParameters rotor;
};
void visit(fields::Visitor& v, LidarSensorConfiguration& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const LidarSensorConfiguration& configuration);

/// What the device requires of its lidar head.
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

/// Puts the firings of each slice on the station's shelf, follows every LidarCommand, and reports
/// the truth of its shots under `name`, the device's in the rig. It fires by its pattern, not by
/// its device's sample plan.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_lidar(
    StationIndex station, std::string_view name, const SensorMount& mount,
    std::unique_ptr<sim::LidarSensor> sensor, LidarPattern pattern);

}  // namespace rigwire::hil
