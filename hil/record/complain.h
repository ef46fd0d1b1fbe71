// Why a run did not begin or ended before it should: a line on standard error, whatever the level
// of the log (hil/record/run_log.h).
#pragma once

#include <chrono>
#include <string>

namespace rigwire::hil {

/// Writes "rigwire: TEXT"; what a terminal would obey in it is spelled out. A reader that does not
/// read is waited for `patience`, then the line is lost: a run waits for nobody.
void complain(const std::string& text,
              std::chrono::milliseconds patience = std::chrono::milliseconds{0});

}  // namespace rigwire::hil
