// UDP without a system: the in-memory twin of UdpSocket, for deterministic tests.
//
// One sender, and at most one listener at a time. Datagrams are posted to the listener's receiver
// through the io_context, in order and whole. As on loopback, a listener that does not keep up
// loses the newest datagrams without the sender noticing (kCapacity bytes are kept), and sending
// with nobody listening succeeds. client_present of the sender: the last datagram found a listener.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

class MemoryDatagramLink {
 public:
  static constexpr std::size_t kCapacity = 212992;

  explicit MemoryDatagramLink(boost::asio::io_context& context,
                              std::string name = "memory datagram");
  MemoryDatagramLink(const MemoryDatagramLink&) = delete;
  MemoryDatagramLink& operator=(const MemoryDatagramLink&) = delete;

  /// The sending end; lives as long as the link.
  [[nodiscard]] DatagramSocket& sender();
  /// Opens the listening end; destroying it closes the port. Throws EndpointError while another
  /// listener is open, as a port that is taken.
  [[nodiscard]] std::unique_ptr<DatagramSocket> open_listener();
  /// Datagrams that the listener lost.
  [[nodiscard]] std::uint64_t lost() const;

  struct State;

 private:
  std::shared_ptr<State> state_;
  std::unique_ptr<DatagramSocket> sender_;
};

}  // namespace rigwire::drivers
