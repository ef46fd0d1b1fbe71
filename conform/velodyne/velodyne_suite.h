// The suite velodyne records and checks what a spinning lidar sends to its two UDP ports. It sends
// nothing.
//
// Documents: HDL-32E user's manual 63-9113 Rev. H ("Packet format", "Position packet"); VLP-16
// user's manual 63-9243 Rev. D (9.3 data packet, 9.4 position packet); VLP-32C user's manual
// 63-9325 Rev. B; HDL-64E S3 user's manual 63-HDL64ES3 Rev. K, appendix E; VLS-128 user's manual
// 63-9483 Rev. A, chapter 9. docs/devices/velodyne-packets.md says which source describes what.
//
// Time is the sensor's own, by its timestamps; only the chapter timing uses the arrival times of
// packets, which depend on this machine and the network, too.
#pragma once

#include <chrono>
#include <vector>

#include "conform/conformance_case.h"
#include "conform/datagram_line.h"
#include "conform/endpoint.h"
#include "conform/suite_options.h"
#include "conform/trial.h"
#include "conform/velodyne/velodyne_log.h"

namespace rigwire::conform {

struct VelodyneCase {
  CaseIdentity identity;
  /// What the case needs and the sensor does not send or claim; empty: nothing.
  std::string (*missing)(const VelodyneLog& log, const VelodyneClaims& claims);
  void (*run)(Trial& trial, const VelodyneLog& log, const VelodyneClaims& claims);
};
[[nodiscard]] std::vector<VelodyneCase> velodyne_cases();

/// The chapters: a row each, in their order.
struct VelodyneRow {
  const char* chapter;
  const char* title;
  const char* source;
  Strength strength;
  decltype(VelodyneCase::missing) missing;
  decltype(VelodyneCase::run) run;
};
[[nodiscard]] std::vector<VelodyneRow> velodyne_data_rows();
[[nodiscard]] std::vector<VelodyneRow> velodyne_azimuth_rows();
[[nodiscard]] std::vector<VelodyneRow> velodyne_time_rows();
[[nodiscard]] std::vector<VelodyneRow> velodyne_return_rows();
[[nodiscard]] std::vector<VelodyneRow> velodyne_position_rows();
[[nodiscard]] std::vector<VelodyneRow> velodyne_status_rows();

/// Records at the port of a UDP endpoint, and at the claimed port of position packets, for `span`.
/// Throws Unreachable.
[[nodiscard]] VelodyneLog listen_velodyne(const Endpoint& endpoint, std::chrono::nanoseconds span,
                                          const VelodyneClaims& claims);

/// Records at open ports, on their clock: first the port of data packets, then the one of position
/// packets. At most 32 MiB per second are kept (VelodyneLog::overflow).
[[nodiscard]] VelodyneLog listen_velodyne(DatagramLine& line, std::chrono::nanoseconds span,
                                          const VelodyneClaims& claims);

/// Runs the suite on the recorded packets.
[[nodiscard]] SuiteResult run_velodyne_suite(const VelodyneLog& log, const VelodyneClaims& claims,
                                             const SuiteOptions& options);

/// Returns the claims that match a recording. Throws Unreachable when more came than is kept.
[[nodiscard]] VelodyneClaims survey_velodyne(const VelodyneLog& log);

/// Names of return modes and of pulse states, as claims have them.
[[nodiscard]] std::string_view return_mode_name(protocols::velodyne::ReturnMode mode);
[[nodiscard]] std::string_view pulse_state_name(std::uint8_t state);

}  // namespace rigwire::conform
