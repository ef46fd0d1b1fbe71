// Shows a recording on a page, from any instant: `rigwire replay FOLDER --dashboard`.
#pragma once

#include <filesystem>

#include "hil/control/run.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// Runs the recording again (hil/control/showing.h) with the page, and once more from its start
/// after each seek backward, at the same address and with the same token. `options` give the pace,
/// the control and the descriptor for the ready line; playback starts at `from`. Returns as run(),
/// and reports on standard error what differs from the recorded run. Throws as Rerun.
[[nodiscard]] int show_recording(const std::filesystem::path& folder, RunOptions options,
                                 SimTime from);

}  // namespace rigwire::hil
