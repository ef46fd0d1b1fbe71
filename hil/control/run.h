// Runs one rig to its end: what `rigwire run` does after everything was read and checked.
#pragma once

#include <optional>
#include <string>

#include "hil/executive/clock.h"
#include "hil/rig/rig_configuration.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

enum class StatusStyle {
  live,   ///< A table refreshed in place; needs a terminal.
  plain,  ///< One block of lines per period, for logs.
  none
};

struct RunOptions {
  ClockMode clock;
  std::optional<Duration> duration;  ///< Simulated time; without it until a signal.
  std::string report_path;           ///< Empty: no report.
  std::string truth_path;            ///< Empty: as the rig says.
  std::string lidar_truth_path;      ///< Empty: as the rig says.
  StatusStyle status = StatusStyle::live;
  bool colour = true;  ///< False with NO_COLOR, or when the output is no terminal.
};

/// Exit codes of every verb (docs/command-line.md). 128 + n after signal n.
enum class ExitCode : int { done = 0, failure = 1, usage = 2, environment = 3 };

/// Opens the wires, runs, closes them, writes the report. Returns the exit code; prints what went
/// wrong to standard error.
[[nodiscard]] int run(const RigConfiguration& configuration, const RunOptions& options);

}  // namespace rigwire::hil
