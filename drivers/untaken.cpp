#include "drivers/untaken.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

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

namespace {

/// The IPv4 address that a socket is bound to, 0 for every one, out of a table's column: words of
/// memory in hexadecimal. Nothing: it takes no datagrams of IPv4.
std::optional<std::uint32_t> bound_address(std::string_view column) {
  constexpr std::size_t kWord = 8;  // digits
  constexpr std::string_view kMapped =
      "0000000000000000FFFF0000";  // ::ffff:0:0/96, RFC 4291 2.5.5.2
  const bool is_v6 = column.size() == 4 * kWord;
  if (!is_v6 && column.size() != kWord) {
    return std::nullopt;
  }
  const std::string_view last = column.substr(column.size() - kWord);
  std::uint32_t address = 0;
  if (std::from_chars(last.data(), last.data() + kWord, address, 16).ec != std::errc{}) {
    return std::nullopt;
  }
  if (is_v6 && !column.starts_with(kMapped) && column.find_first_not_of('0') != column.npos) {
    return std::nullopt;
  }
  return ntohl(address);
}

}  // namespace

std::optional<std::size_t> untaken_datagrams(const IpEnd& destination) {
  std::optional<std::size_t> waiting;
  for (const char* const file : {"/proc/net/udp", "/proc/net/udp6"}) {
    std::ifstream table(file);
    std::string line;
    std::getline(table, line);  // the heading
    while (std::getline(table, line)) {
      // sl, local address and port, remote, state, send and receive queue; hexadecimal.
      std::array<char, 33> local{};
      std::uint32_t port = 0;
      std::uint32_t receiving = 0;
      if (std::sscanf(line.c_str(),
                      " %*d: %32[0-9A-F]:%4" SCNx32 " %*[0-9A-F]:%*x %*x %*x:%8" SCNx32,
                      local.data(), &port, &receiving) != 3 ||
          port != destination.port) {
        continue;
      }
      const auto bound = bound_address(local.data());
      if (bound && (*bound == 0 || *bound == destination.address)) {
        waiting = waiting.value_or(0) + receiving;
      }
    }
  }
  return waiting;
}

}  // namespace rigwire::drivers
