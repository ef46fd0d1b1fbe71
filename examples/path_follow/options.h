// The command line of the path follower.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "field/drive_program.h"
#include "path_follow/path_mission.h"

namespace rigwire::path_follow {

struct Options : field::DriveOptions {
  std::string path;
  PathMissionSettings mission;
};

/// `arguments` without the program's name. Throws field::UsageError.
[[nodiscard]] Options parse_options(std::span<const std::string_view> arguments);
[[nodiscard]] std::string usage();

}  // namespace rigwire::path_follow
