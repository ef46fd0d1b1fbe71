// The report of a run: what --report writes.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hil/configuration/fault_window.h"
#include "hil/executive/clock.h"
#include "hil/executive/executive.h"
#include "hil/executive/truth_source.h"
#include "hil/wires/wire_statistics.h"

namespace rigwire::hil {

struct DeviceReport {
  std::string name;
  std::string wire;
  std::uint64_t frames = 0;
  WireStatistics statistics;
  std::optional<ClientRequest> last_request;
  std::vector<NamedCount> counts;  ///< Counts of the device's own, beside frames.
  std::string remark{};            ///< Remark of the device; may be empty.
};

struct RunReport {
  std::string rig;
  std::uint64_t seed = 0;
  std::string config_hash;
  ClockMode clock;
  OverrunPolicy overrun = OverrunPolicy::slip;
  RunOutcome outcome;
  /// User and system time of the process, but for what keeps processors awake.
  double cpu_s = 0.0;
  double peak_rss_mb = 0.0;  ///< Peak resident memory of the process, 1e6 bytes.
  TruthStages truth;
  WireStages wire;
  std::vector<DeviceReport> devices;
  std::vector<FaultWindow> faults;  ///< Faults of the rig's file that acted in this run.
};

/// Counts by their upper edge in microseconds, [[10, 4], ...]; null: what is above all.
[[nodiscard]] nlohmann::ordered_json lateness_json(const LatencyClasses& classes);

/// The report as JSON text, keys as docs/command-line.md lists them. Lateness is 0 when
/// free-running: simulated time waits for the write there.
[[nodiscard]] std::string to_json(const RunReport& report);

/// Returns the report's figures as Prometheus text, format 0.0.4, also during a run; those of the
/// truth's stages are left out.
[[nodiscard]] std::string to_prometheus(const RunReport& report);

/// User and system CPU time of this process so far, and its peak resident memory.
[[nodiscard]] double process_cpu_seconds();
[[nodiscard]] double peak_resident_megabytes();

}  // namespace rigwire::hil
