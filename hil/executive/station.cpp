#include "hil/executive/station.h"

namespace rigwire::hil {

void Station::collect(DeviceIndex self, TruthRequests& requests) {
  const SamplePlan plan = device_.sample_plan();
  if (plan != announced_plan_) {
    announced_plan_ = plan;
    requests.plans.push_back({self, plan});
  }
}

SimTime LidarStation::next_wakeup() const {
  return std::min(device().next_event(), backend().packet_complete_at());
}

void LidarStation::collect(DeviceIndex self, TruthRequests& requests) {
  Station::collect(self, requests);
  const LidarCommand& command = backend().command();
  if (command != announced_command_) {
    announced_command_ = command;
    requests.lidar_commands.push_back({self, command});
  }
}

void ValveStation::collect(DeviceIndex self, TruthRequests& requests) {
  Station::collect(self, requests);
  const ValveCommand& command = backend().command();
  if (command.opening != announced_command_.opening ||
      command.floating != announced_command_.floating) {
    announced_command_ = command;
    requests.valve_commands.push_back({self, command});
  }
}

void VehicleStation::collect(DeviceIndex self, TruthRequests& requests) {
  Station::collect(self, requests);
  const VehicleCommand& command = backend().command();
  if (command != announced_command_) {
    announced_command_ = command;
    requests.vehicle_commands.push_back({self, command});
  }
}

}  // namespace rigwire::hil
