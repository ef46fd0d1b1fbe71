// find_rocks: a field program. It knows one wire only: GigE Vision on UDP. It cannot distinguish a
// real stereo camera from an emulated one at the other end.
#include <boost/asio/io_context.hpp>

#include "find_rocks/options.h"
#include "find_rocks/program.h"

int main(int count, char** values) {
  using namespace rigwire;
  return field::run_program("find_rocks", count, values, find_rocks::parse_options,
                            find_rocks::usage(), [](const find_rocks::Options& options) {
                              boost::asio::io_context context(1);
                              return find_rocks::Program(context, options).run();
                            });
}
