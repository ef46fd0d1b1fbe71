// path_follow: a field program. It knows wires only: NMEA on a serial line, J1939 and ISO 11783
// frames on CAN, a lidar's packets on UDP. It cannot distinguish a real vehicle from an emulated
// one at the other ends.
#include <boost/asio/io_context.hpp>
#include <string>

#include "field/drive_program.h"
#include "field/geometry.h"
#include "path_follow/path_file.h"
#include "path_follow/path_mission.h"

namespace rigwire::path_follow {
namespace {

struct Options : field::DriveOptions {
  Options() { lidar_mount = {4.2, 0.0, 3.1, 0.0, 0.0}; }

  std::string path;
  PathMissionSettings mission;
};

field::Setters<Options> make_setters() {
  using field::number;
  field::Setters<Options> setters;
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
  setters["--lidar-port"] = [](Options& o, auto n, auto v) { o.lidar_port = field::port(n, v); };
  setters["--lidar-address"] = [](Options& o, auto, auto v) { o.lidar_address = v; };
  setters["--lidar-mount"] = [](Options& o, auto n, auto v) {
    o.lidar_mount = field::lidar_mount(n, v, o.lidar_mount);
  };
  setters["--front"] = [](Options& o, auto n, auto v) {
    o.mission.way.front_m = number(n, v, 0, 20, "metres, 0..20");
  };
  setters["--width"] = [](Options& o, auto n, auto v) {
    o.mission.way.half_width_m = 0.5 * number(n, v, 0.2, 20, "metres, 0.2..20");
  };
  setters["--heading"] = [](Options& o, auto n, auto v) {
    o.mission.start_heading_rad =
        field::turned_compass(number(n, v, -360, 360, "degrees, -360..360") * field::kDegree);
  };
  return setters;
}

Options parse_options(std::span<const std::string_view> arguments) {
  Options options = field::parse_drive(arguments, make_setters());
  if (options.path.empty() && !options.help) {
    throw field::UsageError("--path: missing, allowed a file of latitudes and longitudes");
  }
  return options;
}

const std::string kUsage =
    std::string(
        R"(path_follow: drives a vehicle along a path by GNSS, odometry and a yaw gyroscope, and stops
before what a lidar sees in its way.

usage: path_follow --path FILE [options]

work
  --path FILE             "latitude,longitude" lines; a line "closed" joins the ends
  --speed V               at most, m/s                             (2)
  --laps N                of a closed path, 0 = for ever           (1)
  --gear N                to drive in; chosen by the speed when not given
  --off-path M            farther off than this it stops           (3.5)
  --heading DEG           compass heading at the start; along the path when not given
obstacles
  --lidar-port N          Velodyne data packets; not given: it drives blind
  --lidar-address ADDRESS where they arrive                        (127.0.0.1)
  --lidar-mount X,Y,Z[,YAW,PITCH]  m and degrees, from the odometry's reference point on the
                          ground                                   (4.2,0,3.1)
  --front M               the vehicle's front, from the same point (4.8)
  --width M               what it needs free                       (3)
)") +
    std::string(field::kDriveUsage) +
    "example: path_follow --path configs/paths/forest_track.csv --lidar-port 2368 --log "
    "/tmp/driven.jsonl\n";

int run(const Options& options) {
  const PathFile file = load_path(options.path);
  const field::LocalPlane plane(file.points.front());
  PathMission mission(to_polyline(file, plane), options.mission);
  boost::asio::io_context context(1);
  return field::DriveProgram(context, "path_follow", options, plane, mission).run();
}

}  // namespace
}  // namespace rigwire::path_follow

int main(int count, char** values) {
  using namespace rigwire;
  return field::run_program("path_follow", count, values, path_follow::parse_options,
                            path_follow::kUsage, path_follow::run);
}
