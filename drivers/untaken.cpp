#include "drivers/untaken.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <string>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

std::optional<std::size_t> untaken_bytes(const std::filesystem::path& terminal) {
  const Descriptor slave(::open(terminal.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!slave.open() || ::isatty(slave.get()) == 0) {
    return std::nullopt;
  }
  // What was written may be on its way within the kernel; where nothing has arrived, poll() lets it
  // (drivers/tty/n_tty.c, n_tty_poll).
  pollfd state{slave.get(), POLLIN, 0};
  (void)::poll(&state, 1, 0);
  int waiting = 0;
  if (::ioctl(slave.get(), FIONREAD, &waiting) != 0) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(waiting);
}

std::optional<std::size_t> untaken_datagrams(const IpEnd& destination) {
  std::ifstream table("/proc/net/udp");
  std::optional<std::size_t> waiting;
  std::string line;
  std::getline(table, line);  // the heading
  while (std::getline(table, line)) {
    // sl, local address and port, remote, state, send and receive queue; hexadecimal, the address
    // as it lies in memory.
    std::uint32_t local = 0;
    std::uint32_t port = 0;
    std::uint32_t receiving = 0;
    if (std::sscanf(line.c_str(), " %*d: %8" SCNx32 ":%4" SCNx32 " %*x:%*x %*x %*x:%8" SCNx32,
                    &local, &port, &receiving) == 3 &&
        port == destination.port && (local == 0 || ntohl(local) == destination.address)) {
      waiting = waiting.value_or(0) + receiving;
    }
  }
  return waiting;
}

}  // namespace rigwire::drivers
