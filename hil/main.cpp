// rigwire: simulated field machines on the wires of real devices.
//
// Only bytes that a real device would send cross the boundary to the field software. Ground truth
// leaves through one separate tap (`run --truth FILE`), never through a device.
#include <fcntl.h>
#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

#include "hil/command_line/command_line.h"

namespace {

/// A file that is opened in the place of a closed standard one would get what is meant for that.
void keep_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) < 0) {
      static_cast<void>(::open("/dev/null", O_RDWR));
    }
  }
}

}  // namespace

int main(int count, char** arguments) {
  keep_standard_descriptors();
  return rigwire::hil::run_command_line(std::vector<std::string>(arguments + 1, arguments + count),
                                        std::cout, std::cerr);
}
