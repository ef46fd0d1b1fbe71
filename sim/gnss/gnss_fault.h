// What is done to a receiver's signals: a schedule of faults, and what they amount to at an
// instant.
//
// Overlaps: antenna faults and an outage leave no signal, whatever else goes on (a short-circuited
// antenna is reported before an open one); jamming adds up in dB; jumps and spoof drifts add up in
// metres. Faults are of simulated time, so that a run repeats.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/samples/gnss_sample.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

enum class GnssFaultKind : unsigned char {
  outage,             ///< No signal arrives; the antenna itself is well.
  jamming,            ///< Carrier-to-noise density falls, the noise floor rises.
  spoof_drift,        ///< Strong false signals of all satellites, consistent, drift away.
  jump,               ///< Ranges of a place beside the true one; signals otherwise true.
  antenna_short,      ///< No signal, the antenna supply reports a short circuit.
  antenna_open,       ///< No signal, the antenna supply reports no current.
  correction_outage,  ///< Corrections (SBAS, service, RTK base) no longer arrive.
};

struct GnssFault {
  GnssFaultKind kind = GnssFaultKind::outage;
  Duration start{0};  ///< From the start of the run.
  Duration duration = std::chrono::seconds{10};
  double jamming_db = 20.0;                              ///< [0, 80].
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();    ///< Jump: east, north, up.
  Eigen::Vector3d drift_mps = Eigen::Vector3d::UnitX();  ///< Spoofing: east, north, up.
  double clock_drift_mps = 0.0;                          ///< Spoofing: of all ranges.
};

/// Throws std::invalid_argument naming the value and what is allowed.
void validate(const GnssFault& fault);

/// What all faults amount to.
struct GnssFaultState {
  bool no_signal = false;
  AntennaState antenna = AntennaState::ok;
  double jamming_db = 0.0;
  bool spoofed = false;
  bool corrections_lost = false;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  ///< East, north, up, of the place received.
  Eigen::Vector3d offset_rate_mps = Eigen::Vector3d::Zero();
  double clock_offset_m = 0.0;  ///< Common to all ranges.
  double clock_offset_rate_mps = 0.0;
};

/// A fault lasts from its start up to, but not including, its end.
[[nodiscard]] GnssFaultState fault_state(const std::vector<GnssFault>& faults, SimTime time);

}  // namespace rigwire::sim
