// The whole rig in this process: its speed without pacing, and its bytes' lateness in real time.
//
// Wires are private ones (private_rig.h); no client reads the ptys and the datagrams, and one
// Modbus master exchanges registers when the run is paced. The lidar fires all its 694 444 shots a
// second.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/executive/executive.h"
#include "hil/record/report.h"
#include "sim/samples/time.h"

namespace rigwire::bench {

struct FreeRun {
  int threads = 1;  ///< Threads that cast rays.
  double sim_s = 0.0;
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< CPU time of the process during the run.
  double realtime_factor = 0.0;
  double points_per_s = 0.0;  ///< Laser shots cast, encoded and written per second of wall time.
  hil::TruthStages truth;
  hil::WireStages wire;
  /// Peak memory of the process so far, including the building of the rig; 1e6 B.
  double peak_rss_mb = 0.0;
  std::vector<hil::DeviceReport> devices;
};

/// Throws std::runtime_error when the run ends early.
[[nodiscard]] FreeRun measure_free_run(Duration duration, int threads);

/// True when every device sent the same bytes with the same due times in both.
[[nodiscard]] bool same_bytes(const FreeRun& a, const FreeRun& b);

struct PacedRun {
  hil::RunOutcome outcome;
  double cpu_share = 0.0;       ///< CPU seconds per second of wall time, of the whole process.
  std::uint64_t exchanges = 0;  ///< Answered exchanges of the Modbus master.
  std::chrono::milliseconds exchange_period{};  ///< Between two of them.
  std::vector<hil::DeviceReport> devices;
};

/// Real time, with one Modbus master that exchanges registers by function 23 from a thread of its
/// own. Throws std::runtime_error when the run ends early.
[[nodiscard]] PacedRun measure_paced_run(Duration duration);

}  // namespace rigwire::bench
