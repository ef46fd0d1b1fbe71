// Machines from their configuration: the one place that knows every topology.
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "hil/configuration/machine.h"
#include "sim/ground/ground.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// X_WB: where the first link's origin stands; a machine on wheels settles from there. `ground`
/// must outlive the machine, which may dig in it. Throws std::invalid_argument for parameters that
/// make no machine.
[[nodiscard]] std::unique_ptr<sim::Machine> make_machine(const MachineSettings& settings,
                                                         sim::Ground& ground,
                                                         const Eigen::Isometry3d& X_WB);

/// Along world -z, for the inertial units.
[[nodiscard]] double gravity_mps2(const MachineSettings& settings);

}  // namespace rigwire::hil
