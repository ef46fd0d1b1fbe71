// The suite ubx: a u-blox receiver is asked for what it claims, and told what it has to take or to
// refuse. What speaks NMEA beside it is held to the suite nmea.
//
// Documents: UBX-13003221 R28 (u-blox 8 and M8) and, of configuration items and the messages that
// came later, UBXDOC-963802114-12815 (ZED-F9P, HPG 1.50).
#pragma once

#include <vector>

#include "conform/suite_options.h"
#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

[[nodiscard]] std::vector<UbxCase> ubx_cases();

/// Asks the receiver. Throws Unreachable when the line cannot be opened.
[[nodiscard]] SuiteResult run_ubx_suite(UbxDevice& device, const SuiteOptions& options);

/// The messages that a poll is answered with, and the rate that CFG-RATE tells. Throws Unreachable.
[[nodiscard]] UbxClaims survey_ubx(UbxDevice& device);

}  // namespace rigwire::conform
