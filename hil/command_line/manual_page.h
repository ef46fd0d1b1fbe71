// The manual page, from the same declarations as --help.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace rigwire::hil {

/// Returns rigwire(1) as man(7) source: synopsis, verbs with their arguments and options, examples,
/// exit codes. `version` is in its footer. No date: the same program prints the same page.
[[nodiscard]] std::string manual_page(const CLI::App& app, const std::string& version);

}  // namespace rigwire::hil
