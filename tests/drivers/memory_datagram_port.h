// UDP ports without a system: the in-memory twin of UdpPort, for deterministic tests.
//
// A network of ports by address and port. Datagrams are posted through the io_context, in order and
// whole; to 255.255.255.255 and to 127.255.255.255 they reach every port of that number that hears
// broadcasts. To where nobody is they are lost without the sender noticing.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

class MemoryDatagramNetwork {
 public:
  explicit MemoryDatagramNetwork(boost::asio::io_context& context);

  /// Destroying it closes the port; port 0: the next that is free. Throws EndpointError for one
  /// that is taken.
  [[nodiscard]] std::unique_ptr<DatagramPort> open(std::uint32_t address, std::uint16_t port,
                                                   bool broadcasts);
  /// Where it is.
  [[nodiscard]] static DatagramPort::Peer end_of(const DatagramPort& port);

  struct State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace rigwire::drivers
