// What a rig is doing right now: the content of the status table, taken on the wire thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emulators/can/can_bus.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// A CAN bus.
struct BusStatus {
  std::string name;
  double load = 0.0;  ///< Share of the last second that it was busy.
  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;
  std::vector<emulators::CanNodeStatus> nodes;  ///< Their names live as long as the rig.
};

struct RigStatus {
  SimTime now{};
  double wall_s = 0.0;  ///< Since the start of the run.
  Duration slipped{0};
  std::vector<DeviceStatus> devices;
  std::vector<BusStatus> buses;
  std::vector<FaultWindow> faults;  ///< Faults that act now.
  std::vector<double> machine;      ///< In the order of TruthSource::state_quantities().
};

}  // namespace rigwire::hil
