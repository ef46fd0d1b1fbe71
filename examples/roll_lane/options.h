// The command line of the lane roller.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "field/drive_program.h"
#include "roll_lane/lane_mission.h"

namespace rigwire::roll_lane {

struct Options : field::DriveOptions {
  LaneMissionSettings mission;
};

/// `arguments` without the program's name. Throws field::UsageError.
[[nodiscard]] Options parse_options(std::span<const std::string_view> arguments);
[[nodiscard]] std::string usage();

}  // namespace rigwire::roll_lane
