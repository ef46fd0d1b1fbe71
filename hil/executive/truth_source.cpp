#include "hil/executive/truth_source.h"

namespace rigwire::hil {

void SampleBatch::clear() {
  gnss.clear();
  imu.clear();
  for (auto& block : lidar) {
    block.firings.clear();
  }
  valves.clear();
  vehicles.clear();
  encoders.clear();
  state.clear();
}

void TruthRequests::clear() {
  valve_commands.clear();
  vehicle_commands.clear();
  plans.clear();
  lidar_commands.clear();
}

bool TruthRequests::empty() const {
  return valve_commands.empty() && vehicle_commands.empty() && plans.empty() &&
         lidar_commands.empty();
}

}  // namespace rigwire::hil
