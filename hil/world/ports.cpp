#include "hil/world/ports.h"

#include <stdexcept>

#include "hil/world/valve_sections.h"

namespace rigwire::hil {
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
