#include "drivers/line_discipline.h"

#include <fcntl.h>
#include <linux/tty.h>
#include <sys/ioctl.h>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

bool slcan_attached(const std::string& terminal) {
  const Descriptor line(::open(terminal.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  int discipline = 0;
  return line.open() && ::ioctl(line.get(), TIOCGETD, &discipline) == 0 && discipline == N_SLCAN;
}

}  // namespace rigwire::drivers
