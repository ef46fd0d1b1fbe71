// One run of a campaign, from its index to its folder.
//
// The rig runs in a process of its own, on wires of its own (hil/rig/isolated_rig.h), so that what
// makes it crash leaves this one to write the row. It is governed through the control surface like
// any other: `run_until`, `events`, `stop`. The field program runs beside it, another process. Both
// end with this one, however that ends.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>

#include "hil/campaign/campaign_file.h"
#include "hil/campaign/design.h"

namespace rigwire::hil {

enum class RunEnd {
  was_done,  ///< Before; nothing was done.
  passed,
  failed,       ///< Some criterion does not hold.
  crashed,      ///< It could not be judged; it has no DONE, and is run again next time.
  interrupted,  ///< Ended by the signal in `signal`.
};
struct RunResult {
  RunEnd end = RunEnd::crashed;
  std::string what;  ///< Reason when the run crashed or was interrupted.
  int signal = 0;
};

/// Changes of the rig of one run, as `--set` takes them.
[[nodiscard]] std::vector<std::string> sets_of(const Campaign& campaign, const PlannedRun& run);

/// 16 hexadecimal digits of the campaign and of the rig that it changes: runs of another one do not
/// belong beside its own. Throws ConfigurationError.
[[nodiscard]] std::string identity_of(const LoadedCampaign& campaign, const std::string& rig);

/// `rig` is the rig's file. Throws drivers::EndpointError when the folder cannot be written, or
/// another process is at the run.
[[nodiscard]] RunResult run_one(const LoadedCampaign& campaign, const PlannedRun& run,
                                const std::string& rig, const std::filesystem::path& folder);

}  // namespace rigwire::hil
