#include "drivers/loopback_claims.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

// Second bytes of 127.A.B.0/24: below are the addresses that people write into files.
constexpr unsigned kFirstSecondByte = 64;
constexpr unsigned kNetworks = 63 * 256;
constexpr int kPortTries = 64;

[[noreturn]] void refuse(const std::string& what, int error) {
  throw EndpointError(what + ": " + std::strerror(error) + "; " +
                      (error == EMFILE || error == ENFILE ? "raise the limit of open files"
                                                          : "end other isolated runs"));
}

/// The name's socket, or none when another process has it. Throws EndpointError.
std::unique_ptr<Descriptor> claim(const std::string& place) {
  auto held = std::make_unique<Descriptor>(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!held->open()) {
    refuse(place, errno);
  }
  const std::string name = "rigwire " + place;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(name.begin(), name.end(), address.sun_path + 1);  // a leading zero: abstract
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (::bind(held->get(), reinterpret_cast<const sockaddr*>(&address), length) == 0) {
    return held;
  }
  if (errno != EADDRINUSE) {
    refuse(place, errno);
  }
  return nullptr;
}

/// A port of the system's choice, free at every address.
std::uint16_t unbound_port() {
  const Descriptor probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  socklen_t length = sizeof address;
  if (!probe.open() ||
      ::bind(probe.get(), reinterpret_cast<const sockaddr*>(&address), length) != 0 ||
      ::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&address), &length) != 0) {
    refuse("a UDP port", errno);
  }
  return ntohs(address.sin_port);
}

}  // namespace

LoopbackClaims::LoopbackClaims() {
  // Processes that start together begin at different places.
  const auto first = static_cast<unsigned>(::getpid());
  for (unsigned i = 0; i < kNetworks; ++i) {
    const unsigned number = (first + i) % kNetworks;
    network_ = "127." + std::to_string(kFirstSecondByte + number / 256) + "." +
               std::to_string(number % 256);
    if (auto held = claim(network_)) {
      held_.push_back(std::move(held));
      return;
    }
  }
  refuse("a network of loopback", EADDRINUSE);
}

std::string LoopbackClaims::address(unsigned host) const {
  return network_ + "." + std::to_string(host);
}

std::uint16_t LoopbackClaims::datagram_port() {
  for (int i = 0; i < kPortTries; ++i) {
    const std::uint16_t port = unbound_port();
    if (auto held = claim("udp port " + std::to_string(port))) {
      held_.push_back(std::move(held));
      return port;
    }
  }
  refuse("a UDP port", EADDRINUSE);
}

}  // namespace rigwire::drivers
