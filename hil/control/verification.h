// A recorded run once more, compared with its recording: `rigwire replay FOLDER --verify`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/record/recording_comparison.h"
#include "hil/record/run_log.h"

namespace rigwire::hil {

struct Verification {
  std::vector<std::string> remarks;  ///< What is not as in the recorded run, and what was not done.
  std::vector<ComparedStream> streams;
  std::size_t client_acts = 0;  ///< Given again.
  SimTime end{};                ///< Up to where.
  [[nodiscard]] bool equal() const;
};

/// Runs the recorded configuration as fast as it goes on wires of its own, which nobody hears, with
/// the recorded clients, up to the recorded end; records that and compares. Throws what making the
/// rig throws; std::invalid_argument for a folder that is no recording; drivers::EndpointError when
/// it was interrupted or a wire cannot be opened.
[[nodiscard]] Verification verify_recording(const std::filesystem::path& folder, RunLog* log);

}  // namespace rigwire::hil
