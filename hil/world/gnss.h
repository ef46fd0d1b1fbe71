// Satellite receivers' antennas in the simulated world.
//
// The antenna's motion is that of the epoch's own instant; visibility of satellites is computed in
// the scene at the end of the slice.
#pragma once

#include <memory>
#include <string_view>

#include "hil/world/world_sensor.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/local_frame.h"

namespace rigwire::hil {

/// Puts a GnssSample on the station's shelf for each epoch of its plan, follows every GnssCommand
/// and FaultChange<GnssFault> from the next epoch on, and reports the antenna's position to the
/// truth under `name`, the device's in the rig. `frame` is the world's place on Earth.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_gnss(StationIndex station,
                                                           std::string_view name,
                                                           const SensorMount& mount,
                                                           const sim::LocalFrame& frame,
                                                           sim::GnssSensor sensor);

/// Makes the sensor of an antenna that stands on the ground at the point `p_W`.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_gnss(StationIndex station,
                                                           std::string_view name,
                                                           const Eigen::Vector3d& p_W,
                                                           const sim::LocalFrame& frame,
                                                           sim::GnssSensor sensor);

}  // namespace rigwire::hil
