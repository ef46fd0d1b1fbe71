// The suite j1939: one node on a bus is asked, contended with and listened to.
//
// Documents: SAE J1939-21 (data link), J1939-81 (network management), J1939-71 (groups; digital
// annex of October 2020).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "conform/j1939/j1939_trial.h"
#include "conform/suite_options.h"

namespace rigwire::conform {

[[nodiscard]] std::vector<J1939Case> j1939_cases();

/// Throws Unreachable when the bus cannot be opened.
[[nodiscard]] SuiteResult run_j1939_suite(J1939Device& device, const SuiteOptions& options);

/// Returns the claims of the node with that address, else of the node that sends most: its groups
/// with their periods, and the groups of the suite that it answers requests of. Throws Unreachable,
/// also if the node, or every node, is silent.
[[nodiscard]] J1939Claims survey_j1939(J1939Device& device,
                                       std::optional<std::uint8_t> address = {});

}  // namespace rigwire::conform
