// The machine's own ports (sim/machine.h) in the simulated world: what its transducers read goes to
// the devices, and what the devices command comes back.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/world/world_sensor.h"
#include "sim/machine.h"
#include "sim/samples/valve_sample.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::hil {

/// Maps each section of a device's valve block to the machine's actuator that it moves. Devices
/// count sections from 0 in the order of their key `sections`; the machine counts its actuators.
class ValveSections {
 public:
  /// The section of each name moves the actuator of that name. Throws std::invalid_argument for a
  /// name that is not one of `actuators`, and for one that comes twice.
  ValveSections(std::span<const std::string> names, std::span<const std::string_view> actuators);

  /// The device's set points laid over those of the machine; actuators that no section moves keep
  /// theirs. The time is the device's.
  void lay_over(const ValveCommand& device, ValveCommand& machine) const;
  /// What the device's transducers read: those of its own sections, 0 beyond the last.
  [[nodiscard]] ValveSample of_device(const ValveSample& machine) const;

 private:
  std::vector<std::size_t> actuators_;  ///< By section.
};

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
