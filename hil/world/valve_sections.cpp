#include "hil/world/valve_sections.h"

#include <algorithm>
#include <stdexcept>

namespace rigwire::hil {

ValveSections::ValveSections(std::span<const std::string> names,
                             std::span<const std::string_view> actuators) {
  for (const std::string& name : names) {
    const auto found = std::ranges::find(actuators, std::string_view(name));
    const auto actuator = static_cast<std::size_t>(found - actuators.begin());
    if (found == actuators.end()) {
      throw std::invalid_argument("valve section '" + name + "': the machine has no such actuator");
    }
    if (std::ranges::find(actuators_, actuator) != actuators_.end()) {
      throw std::invalid_argument("valve section '" + name + "' is named twice");
    }
    actuators_.push_back(actuator);
  }
}

void ValveSections::lay_over(const ValveCommand& device, ValveCommand& machine) const {
  machine.time = device.time;
  for (std::size_t section = 0; section < actuators_.size(); ++section) {
    machine.opening[actuators_[section]] = device.opening[section];
    machine.floating[actuators_[section]] = device.floating[section];
  }
}

ValveSample ValveSections::of_device(const ValveSample& machine) const {
  ValveSample device = machine;
  device.spool_position.fill(0.0);
  device.port_a_pressure_pa.fill(0.0);
  device.port_b_pressure_pa.fill(0.0);
  for (std::size_t section = 0; section < actuators_.size(); ++section) {
    const std::size_t actuator = actuators_[section];
    device.spool_position[section] = machine.spool_position[actuator];
    device.port_a_pressure_pa[section] = machine.port_a_pressure_pa[actuator];
    device.port_b_pressure_pa[section] = machine.port_b_pressure_pa[actuator];
  }
  return device;
}

}  // namespace rigwire::hil
