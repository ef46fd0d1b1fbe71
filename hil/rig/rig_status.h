// What a rig is doing right now: the content of the status table, taken on the wire thread.
#pragma once

#include <vector>

#include "hil/configuration/fault_window.h"
#include "hil/devices/device.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct RigStatus {
  SimTime now{};
  double wall_s = 0.0;  ///< Since the start of the run.
  Duration slipped{0};
  std::vector<DeviceStatus> devices;
  std::vector<FaultWindow> faults;  ///< That act now.
  std::vector<double> machine;      ///< In the order of TruthSource::state_quantities().
};

}  // namespace rigwire::hil
