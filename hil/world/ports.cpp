#include "hil/world/ports.h"

#include <stdexcept>
#include <utility>

#include "hil/world/valve_sections.h"

namespace rigwire::hil {
namespace {

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

class WorldVehicle final : public StepSensor<VehicleSample> {
 public:
  WorldVehicle(StationIndex station, sim::VehiclePort& port, sim::VehicleSensors sensors)
      : StepSensor(station), port_(port), sensors_(std::move(sensors)) {}

  void take(SimTime frontier, const Shelves& requests) override {
    StepSensor::take(frontier, requests);
    if (const std::vector<VehicleCommand>* commands = requests.find<VehicleCommand>(station())) {
      for (const VehicleCommand& command : *commands) {
        port_.command(command);
      }
    }
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
  return std::make_unique<WorldVehicle>(station, *machine.vehicle_port(), std::move(sensors));
}

}  // namespace rigwire::hil
