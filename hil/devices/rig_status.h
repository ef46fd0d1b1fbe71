// What a rig is doing right now: the content of the status table, taken on the wire thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/executive/truth_source.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct DeviceStatus {
  std::string name;
  std::string wire;          ///< What a client opens.
  std::uint64_t frames = 0;  ///< Messages on the wire since the start.
  std::uint64_t bytes = 0;
  std::uint64_t dropped = 0;
  double nominal_rate_hz = 0.0;  ///< Messages per simulated second; 0 when the device only answers.
  Duration lateness_p50{0};
  Duration lateness_p99{0};
  Duration lateness_max{0};
  bool client_present = false;
  std::optional<Duration> since_client_activity;  ///< Simulated time since a client last sent.
};

struct RigStatus {
  SimTime now{};
  double wall_s = 0.0;  ///< Since the start of the run.
  Duration slipped{0};
  std::vector<DeviceStatus> devices;
  std::vector<double> machine;  ///< In the order of TruthSource::state_quantities().
};

}  // namespace rigwire::hil
