#include "hil/world/ports.h"

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
namespace {

/// What the station's device asked for since the last slice, to the machine's port.
template <class Command, class Port>
void hand_over(StationIndex station, const Shelves& requests, Port& port) {
  if (const std::vector<Command>* commands = requests.find<Command>(station)) {
    for (const Command& command : *commands) {
      port.command(command);
    }
  }
}

class WorldValves final : public StepSensor<ValveSample> {
 public:
  WorldValves(StationIndex station, sim::ValvePort& port, std::span<const std::string> sections)
      : StepSensor(station), port_(port), sections_(sections, port.actuators()) {}

  void take(SimTime frontier, const Shelves& requests) override {
    StepSensor::take(frontier, requests);
    if (const std::vector<ValveCommand>* commands = requests.find<ValveCommand>(station())) {
      for (const ValveCommand& command : *commands) {
        ValveCommand block = port_.commanded();
        sections_.lay_over(command, block);
        port_.command(block);
      }
    }
  }

 private:
  ValveSample measure(const WorldStep& /*step*/, SimTime time) override {
    return sections_.of_device(port_.valve_sample(time));
  }

  sim::ValvePort& port_;
  ValveSections sections_;
};

class WorldPowerUnit final : public StepSensor<PowerUnitSample> {
 public:
  WorldPowerUnit(StationIndex station, sim::PowerUnitPort& port)
      : StepSensor(station), port_(port) {}

  void take(SimTime frontier, const Shelves& requests) override {
    StepSensor::take(frontier, requests);
    hand_over<PowerUnitCommand>(station(), requests, port_);
  }

 private:
  PowerUnitSample measure(const WorldStep& /*step*/, SimTime time) override {
    return port_.power_unit_sample(time);
  }

  sim::PowerUnitPort& port_;
};

class WorldVehicle final : public StepSensor<VehicleSample> {
 public:
  WorldVehicle(StationIndex station, sim::VehiclePort& port, sim::VehicleSensors sensors)
      : StepSensor(station), port_(port), sensors_(sensors) {}

  void take(SimTime frontier, const Shelves& requests) override {
    StepSensor::take(frontier, requests);
    hand_over<VehicleCommand>(station(), requests, port_);
  }

 private:
  VehicleSample measure(const WorldStep& /*step*/, SimTime time) override {
    return sensors_.measure(port_.vehicle_sample(time));
  }

  sim::VehiclePort& port_;
  sim::VehicleSensors sensors_;
};

}  // namespace

sim::ValvePort& valve_port(sim::Machine& machine) {
  if (machine.valve_port() == nullptr) {
    throw std::invalid_argument("the machine has no valve block for a valve driver");
  }
  return *machine.valve_port();
}

std::unique_ptr<WorldSensor> make_world_valves(StationIndex station, sim::Machine& machine,
                                               std::span<const std::string> sections) {
  return std::make_unique<WorldValves>(station, valve_port(machine), sections);
}

std::unique_ptr<WorldSensor> make_world_vehicle(StationIndex station, sim::Machine& machine,
                                                sim::VehicleSensors sensors) {
  if (machine.vehicle_port() == nullptr) {
    throw std::invalid_argument("the machine has no drive train for a vehicle gateway");
  }
  return std::make_unique<WorldVehicle>(station, *machine.vehicle_port(), sensors);
}

std::unique_ptr<WorldSensor> make_world_power_unit(StationIndex station, sim::Machine& machine) {
  if (machine.power_unit_port() == nullptr) {
    throw std::invalid_argument("the machine has no engine with pumps for an engine controller");
  }
  return std::make_unique<WorldPowerUnit>(station, *machine.power_unit_port());
}

}  // namespace rigwire::hil
