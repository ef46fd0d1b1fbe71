// The command line of rigwire: verbs, options, exit codes. docs/command-line.md is its page.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace rigwire::hil {

struct CampaignRequest;
struct ConformRequest;
struct Terminal;

/// Verbs that are programs of their own, so that a user who only runs rigs need not build them:
/// rigwire-conform and rigwire-campaign. Each is this command line with its verb in it; where a
/// verb is missing, the program of its name beside this one replaces this process.
struct CompanionVerbs {
  int (*conform)(const ConformRequest& request, std::ostream& out, std::ostream& err) = nullptr;
  std::vector<std::string> (*conformance_suites)() = nullptr;
  int (*campaign)(const CampaignRequest& request, Terminal terminal) = nullptr;
  std::string (*campaign_schema)() = nullptr;
};

/// Parses and does what was asked; returns the exit code. Results go to `out`, errors to `err`,
/// with control characters escaped; a run writes to the process's own. `arguments` are without the
/// program's name.
[[nodiscard]] int run_command_line(const std::vector<std::string>& arguments, std::ostream& out,
                                   std::ostream& err, const CompanionVerbs& companions = {});

/// Returns the exit code of the process's arguments, with results on standard output. Opens closed
/// standard descriptors first, so that no other file gets their numbers, and their output.
[[nodiscard]] int run_program(int count, char** arguments, const CompanionVerbs& companions = {});

}  // namespace rigwire::hil
