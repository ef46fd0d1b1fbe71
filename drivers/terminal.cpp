#include "drivers/terminal.h"

// The kernel's own header: <termios.h> cannot be included beside it.
#include <asm/termbits.h>
#include <fcntl.h>
#include <linux/tty.h>
#include <sys/ioctl.h>

#include <cstring>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

bool make_terminal_raw(int descriptor, std::optional<std::uint32_t> baud) {
  termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) {
    return false;
  }
  termios2 raw = settings;
  raw.c_iflag = 0;
  raw.c_oflag = 0;
  raw.c_lflag = 0;
  raw.c_cflag &= ~static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB | CRTSCTS);
  raw.c_cflag |= static_cast<tcflag_t>(CS8 | CREAD | CLOCAL);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  if (baud) {
    raw.c_cflag &= ~static_cast<tcflag_t>(CBAUD | CIBAUD);
    raw.c_cflag |= static_cast<tcflag_t>(BOTHER) | static_cast<tcflag_t>(BOTHER) << IBSHIFT;
    raw.c_ispeed = *baud;
    raw.c_ospeed = *baud;
  }
  if (std::memcmp(&raw, &settings, sizeof(raw)) == 0) {
    return true;
  }
  return ::ioctl(descriptor, TCSETS2, &raw) == 0;
}

std::optional<std::uint32_t> terminal_baud(int descriptor) {
  termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) {
    return std::nullopt;
  }
  return settings.c_ospeed;
}

void discard_terminal_input(int descriptor) {
  (void)::ioctl(descriptor, TCFLSH, TCIFLUSH);
}

bool slcan_attached(const std::string& terminal) {
  const Descriptor line(::open(terminal.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  int discipline = 0;
  return line.open() && ::ioctl(line.get(), TIOCGETD, &discipline) == 0 && discipline == N_SLCAN;
}

}  // namespace rigwire::drivers
