// Places on this machine's loopback that one process has to itself among those that ask here:
// networks 127.A.B.0/24, and UDP ports for clients to bind.
//
// Ownership is an abstract Unix socket of the place's name, which belongs to the network namespace
// as the place does, and which the kernel gives back however the process ends.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

class LoopbackClaims {
 public:
  /// Claims a network. Throws EndpointError when none is left.
  LoopbackClaims();

  /// Address number `host`, 1 to 254, of the network: "127.70.12.1".
  [[nodiscard]] std::string address(unsigned host) const;

  /// Returns a UDP port that no socket is bound to at any address of this machine and that no other
  /// caller is given here. Throws EndpointError when none is found.
  [[nodiscard]] std::uint16_t datagram_port();

 private:
  std::string network_;  ///< "127.70.12"
  std::vector<std::unique_ptr<Descriptor>> held_;
};

}  // namespace rigwire::drivers
