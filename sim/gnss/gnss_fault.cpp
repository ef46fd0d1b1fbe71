#include "sim/gnss/gnss_fault.h"

#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kMostJamming_db = 80.0;
constexpr double kFarthest_m = 1e6;
constexpr double kFastest_mps = 1e4;

void require(bool holds, const char* name, double value, const char* allowed) {
  if (!holds) {
    throw std::invalid_argument(std::string("gnss fault: ") + name + " is " +
                                std::to_string(value) + ", allowed: " + allowed);
  }
}

bool within(const Eigen::Vector3d& v, double bound) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= bound;
}

}  // namespace

void validate(const GnssFault& fault) {
  require(fault.start.count() >= 0, "start", to_seconds(fault.start), "0 s and later");
  require(fault.duration.count() > 0, "duration", to_seconds(fault.duration), "above 0 s");
  require(fault.jamming_db >= 0.0 && fault.jamming_db <= kMostJamming_db, "jamming_db",
          fault.jamming_db, "0 to 80");
  require(within(fault.offset_m, kFarthest_m), "offset_m", fault.offset_m.norm(),
          "components to 1e6 m");
  require(within(fault.drift_mps, kFastest_mps), "drift_mps", fault.drift_mps.norm(),
          "components to 1e4 m/s");
  require(fault.clock_drift_mps >= -kFastest_mps && fault.clock_drift_mps <= kFastest_mps,
          "clock_drift_mps", fault.clock_drift_mps, "-1e4 to 1e4");
}

GnssFaultState fault_state(const std::vector<GnssFault>& faults, SimTime time) {
  GnssFaultState state;
  for (const GnssFault& fault : faults) {
    const Duration since = time.time_since_epoch() - fault.start;
    if (since.count() < 0 || since >= fault.duration) {
      continue;
    }
    switch (fault.kind) {
      case GnssFaultKind::outage:
        state.no_signal = true;
        break;
      case GnssFaultKind::jamming:
        state.jamming_db += fault.jamming_db;
        break;
      case GnssFaultKind::spoof_drift:
        state.spoofed = true;
        state.offset_m += to_seconds(since) * fault.drift_mps;
        state.offset_rate_mps += fault.drift_mps;
        state.clock_offset_m += to_seconds(since) * fault.clock_drift_mps;
        state.clock_offset_rate_mps += fault.clock_drift_mps;
        break;
      case GnssFaultKind::jump:
        state.offset_m += fault.offset_m;
        break;
      case GnssFaultKind::antenna_short:
        state.no_signal = true;
        state.antenna = AntennaState::short_circuit;
        break;
      case GnssFaultKind::antenna_open:
        state.no_signal = true;
        if (state.antenna == AntennaState::ok) {
          state.antenna = AntennaState::open;
        }
        break;
      case GnssFaultKind::correction_outage:
        state.corrections_lost = true;
        break;
    }
  }
  return state;
}

}  // namespace rigwire::sim
