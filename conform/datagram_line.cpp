#include "conform/datagram_line.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>

#include "conform/endpoint.h"
#include "drivers/descriptor.h"

namespace rigwire::conform {

namespace {

using Peer = DatagramLine::Peer;

[[noreturn]] void fail(const Peer& peer, const std::string& why) {
  throw Unreachable("udp:" + peer.address + (peer.address.empty() ? "" : ":") +
                    std::to_string(peer.port) + ": " + why);
}

sockaddr_in address_of(const Peer& peer) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(peer.port);
  if (!peer.address.empty() && ::inet_pton(AF_INET, peer.address.c_str(), &address.sin_addr) != 1) {
    fail(peer, "not a numeric address of IPv4");
  }
  return address;
}

Peer peer_of(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
  return {text.data(), ntohs(address.sin_port)};
}

Peer own_end(const drivers::Descriptor& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return peer_of(address);
}

int open_socket(const Peer& peer) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) {
    fail(peer, std::strerror(errno));
  }
  return socket;
}

class Ports final : public DatagramLine {
 public:
  Ports(const std::string& address, std::span<const std::uint16_t> ports) : lost_(ports.size()) {
    for (const std::uint16_t port : ports) {
      open({address, port});
    }
  }

  bool send(std::size_t from_port, const Peer& to, std::span<const std::uint8_t> bytes) override {
    const sockaddr_in address = address_of(to);
    const auto sent = ::sendto(sockets_.at(from_port).get(), bytes.data(), bytes.size(), 0,
                               reinterpret_cast<const sockaddr*>(&address), sizeof address);
    // Refused by an earlier one's peer is not about this one.
    return sent == static_cast<ssize_t>(bytes.size()) || errno == ECONNREFUSED;
  }

  std::optional<Datagram> receive(Clock::time_point deadline) override {
    while (true) {
      for (std::size_t i = 0; i < sockets_.size(); ++i) {
        const std::size_t port = (first_ + i) % sockets_.size();
        if (auto datagram = take(port)) {
          first_ = port + 1;  // A busy port does not keep the others waiting.
          return datagram;
        }
      }
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
      std::vector<pollfd> watched;
      for (const drivers::Descriptor& socket : sockets_) {
        watched.push_back({socket.get(), POLLIN, 0});
      }
      if (left.count() <= 0 ||
          ::poll(watched.data(), watched.size(),
                 static_cast<int>(std::min<std::int64_t>(left.count(), 60'000))) <= 0) {
        return std::nullopt;
      }
    }
  }

  Peer own(std::size_t port) const override { return own_end(sockets_.at(port)); }

  std::uint64_t lost_here() const override {
    std::uint64_t all = 0;
    for (const std::uint32_t each : lost_) {
      all += each;
    }
    return all;
  }

 private:
  void open(const Peer& peer) {
    const sockaddr_in bound = address_of(peer);
    const int socket = sockets_.emplace_back(open_socket(peer)).get();
    constexpr int kQueue_bytes = 8 << 20;  // The system may give less.
    const int on = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &kQueue_bytes, sizeof kQueue_bytes);
    ::setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    ::setsockopt(socket, SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
    if (::bind(socket, reinterpret_cast<const sockaddr*>(&bound), sizeof bound) < 0) {
      fail(peer, std::strerror(errno));
    }
  }

  std::optional<Datagram> take(std::size_t port) {
    sockaddr_in from{};
    iovec piece{buffer_.data(), buffer_.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(std::uint32_t))> control{};
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof from;
    message.msg_iov = &piece;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = ::recvmsg(sockets_[port].get(), &message, 0);
    if (size < 0) {
      return std::nullopt;
    }
    const cmsghdr* const told = CMSG_FIRSTHDR(&message);
    if (told != nullptr && told->cmsg_level == SOL_SOCKET && told->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&lost_[port], CMSG_DATA(told), sizeof lost_[port]);
    }
    return Datagram{port, peer_of(from), Clock::now(), {buffer_.begin(), buffer_.begin() + size}};
  }

  std::deque<drivers::Descriptor> sockets_;
  std::vector<std::uint32_t> lost_;  ///< Datagrams lost per socket since it was opened.
  std::size_t first_ = 0;            ///< Index of the socket that is read first.
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65'536);
};

}  // namespace

std::unique_ptr<DatagramLine> open_datagrams(const std::string& address,
                                             std::span<const std::uint16_t> ports) {
  return std::make_unique<Ports>(address, ports);
}

std::string own_address_towards(const DatagramLine::Peer& peer) {
  const sockaddr_in address = address_of(peer);
  const drivers::Descriptor socket(open_socket(peer));
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0) {
    fail(peer, std::strerror(errno));
  }
  return own_end(socket).address;
}

}  // namespace rigwire::conform
