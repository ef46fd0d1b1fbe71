// dig_cycle: a field program. It knows wires only: NMEA on a serial line, Velodyne packets on UDP,
// J1939 frames on CAN, registers on Modbus TCP. Whether real devices or emulated ones are at the
// other ends, it cannot tell.
#include <boost/asio/io_context.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "dig_cycle/options.h"
#include "dig_cycle/program.h"
#include "drivers/endpoints.h"

int main(int count, char** values) {
  using namespace rigwire;
  const auto complain = [](const std::exception& error) {
    (void)std::fprintf(stderr, "dig_cycle: %s\n", error.what());
  };
  dig_cycle::Options options;
  try {
    const std::vector<std::string_view> arguments(values + 1, values + count);
    options = dig_cycle::parse_options(arguments);
    if (options.help) {
      (void)std::fputs(dig_cycle::usage().data(), stdout);
      return dig_cycle::exit_done;
    }
  } catch (const dig_cycle::UsageError& error) {
    complain(error);
    return dig_cycle::exit_usage;
  }
  try {
    boost::asio::io_context context(1);
    dig_cycle::Program program(context, options);
    return program.run();
  } catch (const std::invalid_argument& error) {
    complain(error);
    return dig_cycle::exit_usage;
  } catch (const std::exception& error) {
    complain(error);
    return dig_cycle::exit_wire;
  }
}
