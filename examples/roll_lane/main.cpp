// roll_lane: a field program. It knows wires only: NMEA on a serial line, J1939 and ISO 11783
// frames on CAN. Whether a real roller or an emulated one is at the other ends, it cannot tell.
#include <boost/asio/io_context.hpp>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "field/drive_program.h"
#include "roll_lane/lane_mission.h"
#include "roll_lane/options.h"

int main(int count, char** values) {
  using namespace rigwire;
  const auto complain = [](const std::exception& error) {
    (void)std::fprintf(stderr, "roll_lane: %s\n", error.what());
  };
  try {
    const std::vector<std::string_view> arguments(values + 1, values + count);
    const roll_lane::Options options = roll_lane::parse_options(arguments);
    if (options.help) {
      (void)std::fputs(roll_lane::usage().c_str(), stdout);
      return field::exit_done;
    }
    roll_lane::LaneMission mission(options.mission);
    boost::asio::io_context context(1);
    field::DriveProgram program(context, "roll_lane", options, std::nullopt, mission);
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
