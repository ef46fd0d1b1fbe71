#include "path_follow/options.h"

#include "field/angle.h"

namespace rigwire::path_follow {
namespace {

field::Setters<Options> make_setters() {
  using field::number;
  field::Setters<Options> setters;
  field::add_drive_setters(setters);
  setters["--path"] = [](Options& o, auto, auto v) { o.path = v; };
  setters["--speed"] = [](Options& o, auto n, auto v) {
    o.mission.follower.cruise_mps = number(n, v, 0.3, 15, "m/s, 0.3..15");
  };
  setters["--laps"] = [](Options& o, auto n, auto v) {
    o.mission.follower.laps = number(n, v, 0, 1e6, "a number, 0 = for ever");
  };
  setters["--gear"] = [](Options& o, auto n, auto v) {
    o.mission.gear = static_cast<int>(field::whole(n, v, 8, "a gear, 1..8"));
  };
  setters["--off-path"] = [](Options& o, auto n, auto v) {
    o.mission.follower.off_path_m = number(n, v, 0.2, 100, "metres, 0.2..100");
  };
  setters["--heading"] = [](Options& o, auto n, auto v) {
    o.mission.start_heading_rad =
        field::turned_compass(number(n, v, -360, 360, "degrees, -360..360") * field::kDegree);
  };
  return setters;
}

}  // namespace

Options parse_options(std::span<const std::string_view> arguments) {
  field::Flags<Options> flags;
  field::add_drive_flags(flags);
  Options options = field::parse(arguments, make_setters(), flags);
  if (options.path.empty() && !options.help) {
    throw field::UsageError("--path: missing, allowed a file of latitudes and longitudes");
  }
  return options;
}

std::string usage() {
  return std::string(
             R"(path_follow: drives a vehicle along a path by GNSS, odometry and a yaw gyroscope.

usage: path_follow --path FILE [options]

work
  --path FILE             "latitude,longitude" lines; a line "closed" joins the ends
  --speed V               at most, m/s                             (2)
  --laps N                of a closed path, 0 = for ever           (1)
  --gear N                to drive in; chosen by the speed when not given
  --off-path M            farther off than this it stops           (3.5)
  --heading DEG           compass heading at the start; along the path when not given
)") + std::string(field::kDriveUsage) +
         "example: path_follow --path configs/paths/forest_track.csv --log /tmp/driven.jsonl\n";
}

}  // namespace rigwire::path_follow
