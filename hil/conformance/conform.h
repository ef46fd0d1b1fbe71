// What `rigwire conform` does: opens the way to a device, holds it to its profile by a suite of
// conform/, and tells what came of it.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "hil/command_line/verbs.h"

namespace rigwire::hil {

/// The suites that there are.
[[nodiscard]] std::vector<std::string> conformance_suites();

/// The exit code (docs/command-line.md): different where a case fails or is otherwise than
/// expected, environment where the device cannot be reached. Throws ConfigurationError, and
/// std::invalid_argument for words that are none.
[[nodiscard]] int conform(const ConformRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rigwire::hil
