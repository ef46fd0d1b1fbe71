// A recording on a page, to be looked at from any instant: `rigwire replay FOLDER --dashboard`.
#pragma once

#include <filesystem>

#include "hil/control/run.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// Runs what was recorded once more (hil/control/showing.h) with the page, and again from its start
/// each time that it is sent back, at the same address and with the same token. `options` say the
/// pace, who governs it and who is told that it is ready; `from` is where it begins. Returns as
/// run(), and says on standard error what is not as in the recorded run. Throws as Rerun.
[[nodiscard]] int show_recording(const std::filesystem::path& folder, RunOptions options,
                                 SimTime from);

}  // namespace rigwire::hil
