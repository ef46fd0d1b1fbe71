#include "hil/truth_source.h"

namespace rigwire::hil {

void SampleBatch::clear() {
  gnss.clear();
  imu.clear();
  for (auto& block : lidar) {
    block.firings.clear();
  }
  valves.clear();
  state.clear();
}

void TruthRequests::clear() {
  commands.clear();
  plans.clear();
  rotor_rates.clear();
}

bool TruthRequests::empty() const {
  return commands.empty() && plans.empty() && rotor_rates.empty();
}

}  // namespace rigwire::hil
