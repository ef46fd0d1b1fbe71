// Runs a recorded run again and compares it with its recording: `rigwire replay FOLDER --verify`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/record/recording_comparison.h"
#include "hil/record/run_log.h"

namespace rigwire::hil {

struct Verification {
  /// What differs from the recorded run, and what was not repeated.
  std::vector<std::string> remarks;
  std::vector<ComparedStream> streams;
  std::size_t client_acts = 0;  ///< Number of repeated client actions.
  SimTime end{};                ///< Compared up to here.
  [[nodiscard]] bool equal() const;
};

/// Runs the recorded configuration as fast as possible on private wires that no program receives,
/// with the recorded clients, up to the recorded end; records that and compares. Throws what making
/// the rig throws; std::invalid_argument for a folder that is no recording; drivers::EndpointError
/// when it was interrupted or a wire cannot be opened.
[[nodiscard]] Verification verify_recording(const std::filesystem::path& folder, RunLog* log);

}  // namespace rigwire::hil
