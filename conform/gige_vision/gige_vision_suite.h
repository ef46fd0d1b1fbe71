// The suite gige-vision: an application that asks a camera, and with leave controls it and lets it
// send pictures.
//
// Documents: the text of GigE Vision (AIA/A3) is not public. What is asked is what Wireshark 4.0
// (packet-gvcp.c, packet-gvsp.c) and Aravis 0.8.26 speak; cases name commands and registers
// instead of sections.
#pragma once

#include <vector>

#include "conform/conformance_case.h"
#include "conform/gige_vision/gige_vision_trial.h"
#include "conform/suite_options.h"

namespace rigwire::conform {

[[nodiscard]] std::vector<GigeVisionCase> gige_vision_cases();

/// Throws Unreachable when the camera cannot be asked at all.
[[nodiscard]] SuiteResult run_gige_vision_suite(GigeVisionDevice& device,
                                                const SuiteOptions& options);

/// Claims of a camera whose description is XML in its own memory: where the registers of
/// AcquisitionStart, AcquisitionStop and PayloadSize lie, as far as they have plain addresses.
/// Nothing is written. Throws Unreachable when it does not answer.
[[nodiscard]] GigeVisionClaims survey_gige_vision(GigeVisionDevice& device);

}  // namespace rigwire::conform
