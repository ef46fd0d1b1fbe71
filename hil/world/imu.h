// Inertial units in the simulated world, and magnetometers in their housings.
#pragma once

#include <memory>
#include <optional>

#include "hil/world/world_sensor.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// Puts an ImuSample on the station's shelf for each instant of its plan. Without a magnetometer
/// the field is not a number.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_imu(
    StationIndex station, const SensorMount& mount, sim::ImuSensor sensor,
    std::optional<sim::Magnetometer> magnetometer = std::nullopt);

}  // namespace rigwire::hil
