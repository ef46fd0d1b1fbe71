// The machine's own ports (sim/machine.h) in the simulated world: what its transducers read goes to
// the devices, and what the devices command comes back.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "hil/world/world_sensor.h"
#include "sim/machine.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::hil {

/// Throws std::invalid_argument when the machine has no valve block.
[[nodiscard]] sim::ValvePort& valve_port(sim::Machine& machine);

/// The valve block: a ValveSample on the station's shelf for each instant of its plan, every
/// ValveCommand to the block; each of the device's `sections` moves the actuator of that name.
/// Several devices may command one block, each its own actuators; of one that several command the
/// last that was added counts, within a slice. The machine must outlive it. Throws
/// std::invalid_argument when the machine has no valve block, and as ValveSections.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_valves(StationIndex station,
                                                             sim::Machine& machine,
                                                             std::span<const std::string> sections);

/// The drive train: a VehicleSample as `sensors` read it, every VehicleCommand to the machine. The
/// machine must outlive it. Throws std::invalid_argument when the machine does not drive.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_vehicle(StationIndex station,
                                                              sim::Machine& machine,
                                                              sim::VehicleSensors sensors);

/// Engine and pumps: a PowerUnitSample for each instant of the plan, every PowerUnitCommand to the
/// machine. The machine must outlive it. Throws std::invalid_argument when it has none.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_power_unit(StationIndex station,
                                                                 sim::Machine& machine);

}  // namespace rigwire::hil
