// The suite ubx polls a u-blox receiver for what it claims, and sends what it must accept or
// refuse. The suite nmea checks the NMEA sentences that it sends beside UBX.
//
// Documents: UBX-13003221 R28 (u-blox 8 and M8) and, of configuration items and the messages that
// came later, UBXDOC-963802114-12815 (ZED-F9P, HPG 1.50).
#pragma once

#include <vector>

#include "conform/suite_options.h"
#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

[[nodiscard]] std::vector<UbxCase> ubx_cases();

/// Runs the suite on the receiver. Throws Unreachable when the line cannot be opened.
[[nodiscard]] SuiteResult run_ubx_suite(UbxDevice& device, const SuiteOptions& options);

/// Returns the messages that answer a poll, and the rate that CFG-RATE reports. Throws Unreachable.
[[nodiscard]] UbxClaims survey_ubx(UbxDevice& device);

}  // namespace rigwire::conform
