// What `rigwire conform` does: opens a device, checks it against its profile with a suite of
// conform/, and reports the results.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "hil/command_line/verbs.h"

namespace rigwire::hil {

/// Returns the names of the suites.
[[nodiscard]] std::vector<std::string> conformance_suites();

/// Returns the exit code (docs/command-line.md): different when a case fails or differs from what
/// was expected, environment when the device cannot be reached. Throws ConfigurationError, and
/// std::invalid_argument for unknown words.
[[nodiscard]] int conform(const ConformRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rigwire::hil
