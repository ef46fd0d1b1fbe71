// One UDP socket over IPv4: a sender with a fixed destination, a receiver bound to a port, or both.
//
// - Sending to a port without a listener is neither an error nor counted as a loss: the system's
//   "connection refused" belongs to an earlier datagram, is noted for the status, and the current
//   datagram is sent all the same.
// - A full send buffer refuses the datagram (send() returns false); so does a route that is gone.
// - The destination can change while the socket runs (retarget()); a requested source address and
//   port stay.
// - What a slow reader loses in its own receive buffer is invisible here, as on a real network.
// - client_present of a sender: something was sent, and the system has not reported a refusal
//   within the last second nor since the last datagram. Only local and reachable hosts refuse; a
//   datagram without a receiver elsewhere counts as received. client_present of a receiver: a
//   datagram came within the last second.
#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

struct UdpEndpoint {
  std::string address = "127.0.0.1";  ///< IPv4, dotted.
  std::uint16_t port = 0;
};

struct UdpSettings {
  std::optional<UdpEndpoint> destination = {};  ///< Set: the socket is connected and can send.
  std::optional<UdpEndpoint> bind = {};         ///< Source of what is sent, and where it receives.
  bool broadcast = false;                       ///< Allows a broadcast address as the destination.
  /// The source port is the destination's, whatever `bind` says; `bind` must be set.
  bool source_port_follows = false;
  /// The bound address may be that of other sockets that share theirs, too: senders of one machine
  /// that each play a device with the same port.
  bool shares_source = false;
  /// Time to live in the IP header of sent packets; 0: the system's.
  std::uint8_t time_to_live = 0;
  /// Sets the header's "don't fragment"; its identification is the system's all the same.
  bool dont_fragment = false;
  int receive_buffer_bytes = 1 << 20;  ///< Asked of the system, which may give less.
};

class UdpSocket final : public DatagramSocket {
 public:
  /// Throws EndpointError naming the address: not an IPv4 address, port taken, not of this machine.
  UdpSocket(boost::asio::io_context& context, UdpSettings settings);
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  void start(Receiver receiver) override;
  bool send(std::span<const std::uint8_t> datagram) override;
  /// From now on datagrams go there. Returns what is wrong with the new destination; the old one
  /// stays then. Precondition: the socket has a destination.
  [[nodiscard]] std::optional<std::string> retarget(const UdpEndpoint& destination);
  [[nodiscard]] Ends ends() const override { return ends_; }
  [[nodiscard]] EndpointStatus status() const override;

  /// The port it is bound to; useful when port 0 asked for any.
  [[nodiscard]] std::uint16_t local_port() const;
  /// The address it is bound to, dotted; of a sender the one that its datagrams come from.
  [[nodiscard]] std::string local_address() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// A socket that fulfils the settings. Throws EndpointError.
  [[nodiscard]] static boost::asio::ip::udp::socket open(
      const boost::asio::any_io_executor& executor, const UdpSettings& settings);
  [[nodiscard]] Ends find_ends() const;
  void wait_readable();
  void receive_all();
  void note_refusal() const;

  UdpSettings settings_;
  mutable boost::asio::ip::udp::socket socket_;
  Ends ends_;
  Receiver receiver_;
  std::vector<std::uint8_t> buffer_;
  std::optional<Clock::time_point> last_sent_;
  std::optional<Clock::time_point> last_received_;
  mutable std::optional<Clock::time_point> last_refused_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
