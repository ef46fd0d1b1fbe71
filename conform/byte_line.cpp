#include "conform/byte_line.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "drivers/descriptor.h"
#include "drivers/terminal.h"

namespace rigwire::conform {

namespace {

using std::chrono::milliseconds;

int milliseconds_to(ByteLine::Clock::time_point deadline) {
  const auto left = deadline - ByteLine::Clock::now();
  return static_cast<int>(
      std::clamp<std::int64_t>(std::chrono::ceil<milliseconds>(left).count(), 0, 60'000));
}

class DescriptorLine final : public ByteLine {
 public:
  DescriptorLine(int descriptor, bool socket) : descriptor_(descriptor), socket_(socket) {}

  bool send(std::span<const std::uint8_t> bytes) override {
    const auto deadline = Clock::now() + std::chrono::seconds(1);
    while (!bytes.empty()) {
      const ssize_t count =
          socket_ ? ::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL)
                  : ::write(descriptor_.get(), bytes.data(), bytes.size());
      if (count > 0) {
        bytes = bytes.subspan(static_cast<std::size_t>(count));
      } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
        closed_ = true;
        return false;
      } else if (!ready(POLLOUT, deadline)) {
        return false;
      }
    }
    return true;
  }

  bool receive(std::vector<std::uint8_t>& bytes, Clock::time_point deadline) override {
    std::array<std::uint8_t, 4096> chunk{};
    while (!closed_) {
      const ssize_t count = ::read(descriptor_.get(), chunk.data(), chunk.size());
      if (count > 0) {
        bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + count);
        return true;
      }
      if (count == 0 ? socket_ : errno != EAGAIN && errno != EINTR) {
        closed_ = true;
      } else if (!ready(POLLIN, deadline)) {
        return false;
      }
    }
    return false;
  }

  bool closed() const override { return closed_; }

 private:
  [[nodiscard]] bool ready(short events, Clock::time_point deadline) const {
    pollfd watched{descriptor_.get(), events, 0};
    return ::poll(&watched, 1, milliseconds_to(deadline)) > 0;
  }

  drivers::Descriptor descriptor_;
  bool socket_;
  bool closed_ = false;
};

std::unique_ptr<ByteLine> open_tcp(const Endpoint& endpoint) {
  sockaddr_storage to{};
  socklen_t size = 0;
  auto& v4 = reinterpret_cast<sockaddr_in&>(to);
  auto& v6 = reinterpret_cast<sockaddr_in6&>(to);
  if (::inet_pton(AF_INET, endpoint.address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(endpoint.port);
    size = sizeof v4;
  } else if (::inet_pton(AF_INET6, endpoint.address.c_str(), &v6.sin6_addr) == 1) {
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(endpoint.port);
    size = sizeof v6;
  } else {
    throw Unreachable(endpoint.text() + ": not a numeric address");
  }
  drivers::Descriptor socket(
      ::socket(to.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP));
  int failed = 0;
  if (!socket.open()) {
    failed = errno;
  } else if (::connect(socket.get(), reinterpret_cast<sockaddr*>(&to), size) < 0) {
    failed = errno;
    pollfd watched{socket.get(), POLLOUT, 0};
    constexpr int kPatience_ms = 3000;
    if (failed == EINPROGRESS) {
      socklen_t length = sizeof failed;
      failed = ::poll(&watched, 1, kPatience_ms) > 0 &&
                       ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &failed, &length) == 0
                   ? failed
                   : ETIMEDOUT;
    }
  }
  if (failed != 0) {
    throw Unreachable(endpoint.text() + ": " + std::strerror(failed));
  }
  const int one = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  return std::make_unique<DescriptorLine>(socket.release(), true);
}

std::unique_ptr<ByteLine> open_serial(const Endpoint& endpoint) {
  drivers::Descriptor line(
      ::open(endpoint.address.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!line.open() || !drivers::make_terminal_raw(line.get(), endpoint.rate)) {
    throw Unreachable(endpoint.text() + ": " + std::strerror(errno));
  }
  drivers::discard_terminal_input(line.get());
  return std::make_unique<DescriptorLine>(line.release(), false);
}

}  // namespace

std::unique_ptr<ByteLine> open_bytes(const Endpoint& endpoint) {
  switch (endpoint.kind) {
    case Endpoint::Kind::tcp:
      return open_tcp(endpoint);
    case Endpoint::Kind::serial:
      return open_serial(endpoint);
    case Endpoint::Kind::can:
    case Endpoint::Kind::slcan:
    case Endpoint::Kind::udp:
      break;
  }
  throw std::logic_error(endpoint.text() + " is no line of bytes");
}

}  // namespace rigwire::conform
