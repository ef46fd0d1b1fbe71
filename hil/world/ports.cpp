#include "hil/world/ports.h"

#include <stdexcept>
#include <utility>

namespace rigwire::hil {
namespace {

/// Hands everything of that type on the station's shelf to the port.
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
  WorldValves(StationIndex station, sim::ValvePort& port) : StepSensor(station), port_(port) {}

  void take(SimTime frontier, const Shelves& requests) override {
    StepSensor::take(frontier, requests);
    hand_over<ValveCommand>(station(), requests, port_);
  }

 private:
  ValveSample measure(const WorldStep& /*step*/, SimTime time) override {
    return port_.valve_sample(time);
  }

  sim::ValvePort& port_;
};

class WorldVehicle final : public StepSensor<VehicleSample> {
 public:
  WorldVehicle(StationIndex station, sim::VehiclePort& port, sim::VehicleSensors sensors)
      : StepSensor(station), port_(port), sensors_(std::move(sensors)) {}

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

std::unique_ptr<WorldSensor> make_world_valves(StationIndex station, sim::Machine& machine) {
  if (machine.valve_port() == nullptr) {
    throw std::invalid_argument("the machine has no valve block for a valve driver");
  }
  return std::make_unique<WorldValves>(station, *machine.valve_port());
}

std::unique_ptr<WorldSensor> make_world_vehicle(StationIndex station, sim::Machine& machine,
                                                sim::VehicleSensors sensors) {
  if (machine.vehicle_port() == nullptr) {
    throw std::invalid_argument("the machine has no drive train for a vehicle gateway");
  }
  return std::make_unique<WorldVehicle>(station, *machine.vehicle_port(), std::move(sensors));
}

}  // namespace rigwire::hil
