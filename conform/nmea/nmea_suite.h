// The suite nmea records and checks what a receiver sends by NMEA 0183. It sends nothing.
//
// Documents: u-blox M8 receiver description including protocol specification, UBX-13003221 R28,
// section 31 (NMEA protocol), which describes NMEA 0183 as it is widely read.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "conform/byte_line.h"
#include "conform/conformance_case.h"
#include "conform/nmea/nmea_log.h"
#include "conform/suite_options.h"
#include "conform/trial.h"

namespace rigwire::conform {

/// Claims of a receiver.
struct NmeaClaims {
  std::vector<std::string> sentences;  ///< Types that come in every epoch; empty: not claimed.
  double rate_hz = 0.0;                ///< Epoch rate; 0: not claimed.
};

struct NmeaCase {
  CaseIdentity identity;
  std::function<void(Trial&, const NmeaLog&, const NmeaClaims&)> run;
};
[[nodiscard]] std::vector<NmeaCase> nmea_cases();

/// Records an endpoint's sentences for `span`. Throws Unreachable.
[[nodiscard]] NmeaLog listen_nmea(const Endpoint& endpoint, std::chrono::nanoseconds span);

/// Records the sentences of an open line, on its clock. At most 360 KiB per second are kept
/// (NmeaLog::overflow).
[[nodiscard]] NmeaLog listen_nmea(ByteLine& line, std::chrono::nanoseconds span);

/// Runs the suite on the recorded sentences.
[[nodiscard]] SuiteResult run_nmea_suite(const NmeaLog& log, const NmeaClaims& claims,
                                         const SuiteOptions& options);

/// Returns the claims that match a recording. Throws Unreachable when more came than is kept.
[[nodiscard]] NmeaClaims survey_nmea(const NmeaLog& log);

}  // namespace rigwire::conform
