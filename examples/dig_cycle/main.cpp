// dig_cycle: a field program. It knows wires only: NMEA on a serial line, Velodyne packets on UDP,
// J1939 frames on CAN, registers on Modbus TCP. It cannot distinguish real devices from emulated
// ones at the other ends.
#include <boost/asio/io_context.hpp>

#include "dig_cycle/options.h"
#include "dig_cycle/program.h"

int main(int count, char** values) {
  using namespace rigwire;
  return field::run_program("dig_cycle", count, values, dig_cycle::parse_options,
                            dig_cycle::usage(), [](const dig_cycle::Options& options) {
                              boost::asio::io_context context(1);
                              return dig_cycle::Program(context, options).run();
                            });
}
