// The command line of rigwire: verbs, options, exit codes. docs/command-line.md is its page.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace rigwire::hil {

/// Parses and does what was asked; returns the exit code. Results go to `out`, complaints to `err`,
/// with everything spelled out that a terminal would obey; a run writes to the process's own.
/// `arguments` are without the program's name.
[[nodiscard]] int run_command_line(const std::vector<std::string>& arguments, std::ostream& out,
                                   std::ostream& err);

}  // namespace rigwire::hil
