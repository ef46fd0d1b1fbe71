#include "bench/registry.h"

#include <array>

#include "bench/suites.h"

namespace rigwire::bench {

std::span<const BenchSuite> bench_suites() {
  // The rig first: peak memory is that of the process.
  static constexpr std::array<BenchSuite, 14> kSuites{{
      {"rig", "the whole rig running free: speed, stages, memory", bench_rig},
      {"pacing", "the whole rig in real time: lateness of every device", bench_pacing},
      {"lidar", "the lidar stage against bare Embree, and its range error", bench_lidar},
      {"lidar_peer", "scene and rays for other ray casters (scripts/lidar-peer.py)",
       bench_lidar_peer},
      {"weather", "cost of each medium for a beam, and its error", bench_weather},
      {"camera", "pictures against bare Embree, against many samples; the sensor's noise",
       bench_camera},
      {"excavator", "integration error against step, cost, stiffest drives", bench_excavator},
      {"dynamics", "every machine at every level: cost and error over the step", bench_dynamics},
      {"contact", "solid contact: cost among trees, energy and overlap over the step",
       bench_contact},
      {"gnss", "satellite receivers: every model's cost and error, a lap of the campus",
       bench_gnss},
      {"encoding", "cost of each wire format against what its wire can carry", bench_encoding},
      {"buses", "CAN model, its last hops and Modbus: speed, latency and exactness", bench_buses},
      {"bridge", "runs as processes: ready, stepped, recorded, side by side", bench_bridge},
      {"dashboard", "what somebody who looks on costs a run with lidars at full rate",
       bench_dashboard},
  }};
  return kSuites;
}

}  // namespace rigwire::bench
