// Plans the runs of a campaign and the parameter values of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/campaign/campaign_file.h"

namespace rigwire::hil {

/// One run: a function of the campaign and the index alone.
struct PlannedRun {
  std::size_t index = 0;
  /// Seed of the rig's random streams: 53 bits of the stream "run INDEX" of the campaign's seed, so
  /// that JSON and SQLite hold it exactly.
  std::uint64_t seed = 0;
  /// Values in the order of Campaign::parameters. Empty: the rig's own value (one_at_a_time).
  std::vector<std::optional<std::string>> values;
};

/// All of them, by index; the same for the same campaign on every machine. Each parameter draws
/// from the stream of its own name: another one beside it changes none of its values (but in a
/// grid, and in Sobol's sequence, whose dimensions are the parameters in order of their names).
/// More runs continue `random` and `sobol`, and change every value of `latin_hypercube`. Throws
/// fields::Refused for more than a million runs, or more parameters than Sobol's sequence has here.
[[nodiscard]] std::vector<PlannedRun> plan_runs(const Campaign& campaign);

}  // namespace rigwire::hil
