// path_follow: a field program. It knows wires only: NMEA on a serial line, J1939 and ISO 11783
// frames on CAN. Whether a real vehicle or an emulated one is at the other ends, it cannot tell.
#include <boost/asio/io_context.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "field/drive_program.h"
#include "path_follow/options.h"
#include "path_follow/path_file.h"
#include "path_follow/path_mission.h"

int main(int count, char** values) {
  using namespace rigwire;
  const auto complain = [](const std::exception& error) {
    (void)std::fprintf(stderr, "path_follow: %s\n", error.what());
  };
  try {
    const std::vector<std::string_view> arguments(values + 1, values + count);
    const path_follow::Options options = path_follow::parse_options(arguments);
    if (options.help) {
      (void)std::fputs(path_follow::usage().c_str(), stdout);
      return field::exit_done;
    }
    const path_follow::PathFile file = path_follow::load_path(options.path);
    const field::LocalPlane plane(file.points.front());
    path_follow::PathMission mission(path_follow::to_polyline(file, plane), options.mission);
    boost::asio::io_context context(1);
    field::DriveProgram program(context, "path_follow", options, plane, mission);
    return program.run();
  } catch (const field::UsageError& error) {
    complain(error);
    return field::exit_usage;
  } catch (const std::invalid_argument& error) {
    complain(error);
    return field::exit_usage;
  } catch (const std::exception& error) {
    complain(error);
    return field::exit_wire;
  }
}
