// What a run came to, for people: the same figures as in the report.
#pragma once

#include <string>
#include <vector>

#include "hil/record/report.h"

namespace rigwire::hil {

/// Lines without their ends: the run as a whole (time, slips of the clock, a fault that ended it),
/// a row for each device (frames, bytes, drops, worst lateness, what a client asked last), and each
/// fault of the rig's file that acted, with its window. Nothing in it but the colours can steer a
/// terminal.
[[nodiscard]] std::vector<std::string> draw_summary(const RunReport& report, bool colour);

}  // namespace rigwire::hil
