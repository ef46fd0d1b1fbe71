// The suite canopen: one node on a bus is read, written, commanded and listened to by a master.
// Nothing else should command the node meanwhile.
//
// Documents: CiA 301 V4.2.0 (application layer), CiA 406 V3.2 (encoders).
#pragma once

#include <vector>

#include "conform/canopen/canopen_trial.h"
#include "conform/suite_options.h"

namespace rigwire::conform {

[[nodiscard]] std::vector<CanopenCase> canopen_cases();

/// Throws Unreachable when the bus cannot be opened.
[[nodiscard]] SuiteResult run_canopen_suite(CanopenDevice& device, const SuiteOptions& options);

/// The first node of 1 to 127 that answers to reading 1000, and which of the suite's objects it
/// has. Throws Unreachable, also when none answers.
[[nodiscard]] CanopenClaims survey_canopen(CanopenDevice& device);

}  // namespace rigwire::conform
