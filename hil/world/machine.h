// Machines from their configuration: the one place that knows every topology.
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "hil/world/machine_configuration.h"
#include "sim/excavator/bucket_soil.h"
#include "sim/ground/ground.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// Where a machine is put. Ground and obstacles must outlive it; it may dig in the ground.
struct MachineSite {
  sim::Ground& ground;
  const sim::FallObstacle& obstacles;
  Eigen::Isometry3d X_WB;  ///< Of the first link; a machine on wheels settles from there.
};

/// Throws std::invalid_argument for parameters that make no machine.
[[nodiscard]] std::unique_ptr<sim::Machine> make_machine(const MachineSettings& settings,
                                                         const MachineSite& site);

/// Along world -z, for the inertial units.
[[nodiscard]] double gravity_mps2(const MachineSettings& settings);

/// Whether the machine digs, so that the terrain must be kept in a form that can change.
[[nodiscard]] bool changes_ground(const MachineSettings& settings);

}  // namespace rigwire::hil
