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
#include <charconv>
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

std::unique_ptr<ByteLine> open_tcp(const ByteEndpoint& endpoint) {
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

std::unique_ptr<ByteLine> open_serial(const ByteEndpoint& endpoint) {
  drivers::Descriptor line(
      ::open(endpoint.address.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!line.open() || !drivers::make_terminal_raw(line.get(), endpoint.baud)) {
    throw Unreachable(endpoint.text() + ": " + std::strerror(errno));
  }
  drivers::discard_terminal_input(line.get());
  return std::make_unique<DescriptorLine>(line.release(), false);
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value > 0
             ? std::optional(value)
             : std::nullopt;
}

}  // namespace

std::string ByteEndpoint::text() const {
  if (kind == Kind::serial) {
    return "serial:" + address + "@" + std::to_string(baud);
  }
  const bool v6 = address.find(':') != std::string::npos;
  return "tcp:" + (v6 ? "[" + address + "]" : address) + ":" + std::to_string(port);
}

bool ByteEndpoint::local() const {
  return kind == Kind::serial || address.starts_with("127.") || address == "::1";
}

std::unique_ptr<ByteLine> ByteEndpoint::open() const {
  return kind == Kind::serial ? open_serial(*this) : open_tcp(*this);
}

std::optional<ByteEndpoint> parse_byte_endpoint(const std::string& text, std::uint16_t port,
                                                std::uint32_t baud) {
  ByteEndpoint endpoint;
  endpoint.port = port;
  endpoint.baud = baud;
  if (text.starts_with("serial:")) {
    endpoint.kind = ByteEndpoint::Kind::serial;
    endpoint.address = text.substr(7);
    const std::size_t at = endpoint.address.rfind('@');
    if (at != std::string::npos) {
      const auto speed =
          number_in<std::uint32_t>(std::string_view(endpoint.address).substr(at + 1));
      if (!speed) {
        return std::nullopt;
      }
      endpoint.baud = *speed;
      endpoint.address.resize(at);
    }
    return endpoint.address.empty() ? std::nullopt : std::optional(endpoint);
  }
  if (!text.starts_with("tcp:")) {
    return std::nullopt;
  }
  std::string_view rest = std::string_view(text).substr(4);
  std::string_view number;
  if (rest.starts_with('[')) {
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos) {
      return std::nullopt;
    }
    endpoint.address = rest.substr(1, end - 1);
    rest.remove_prefix(end + 1);
    number = rest.starts_with(':') ? rest.substr(1) : rest;
  } else {
    const std::size_t colon = rest.find(':');
    endpoint.address = rest.substr(0, colon);
    number = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
  }
  if (!number.empty()) {
    const auto chosen = number_in<std::uint16_t>(number);
    if (!chosen) {
      return std::nullopt;
    }
    endpoint.port = *chosen;
  }
  return endpoint.address.empty() ? std::nullopt : std::optional(endpoint);
}

}  // namespace rigwire::conform
