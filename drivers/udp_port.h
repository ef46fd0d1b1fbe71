// One UDP port over IPv4 that receives from any sender and can answer each.
//
// - It is bound to one address of this machine, exclusively: a port that another socket has is
//   refused, also within this program.
// - With `broadcasts` it also receives what is sent to 255.255.255.255 and to the broadcast address
//   of its own network, on the interface that has its address and on no other. Every such port of a
//   machine receives a broadcast, each for itself; answers leave from the port's own address.
// - A destination without a listener is no error; what the system does not take is lost.
// - client_present: a datagram came within the last three seconds.
#pragma once

#include <array>
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

struct UdpPortSettings {
  std::uint32_t address = 0x7F00'0001;  ///< An address of this machine.
  std::uint16_t port = 0;               ///< 0: the system chooses.
  bool broadcasts = false;
  int send_buffer_bytes = 4 << 20;  ///< Asked of the system, which may give less.
};

class UdpPort final : public DatagramPort {
 public:
  /// Throws EndpointError naming the address: port taken, not of this machine.
  UdpPort(boost::asio::io_context& context, const UdpPortSettings& settings);
  ~UdpPort() override;
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  void start(Receiver receiver) override;
  bool send(const Peer& to, std::span<const std::uint8_t> datagram, bool do_not_fragment) override;
  [[nodiscard]] IpEnd end() const override { return {settings_.address, local_port_}; }
  [[nodiscard]] EndpointStatus status() const override;

  [[nodiscard]] std::uint16_t local_port() const { return local_port_; }

 private:
  using Clock = std::chrono::steady_clock;
  /// A receiving socket; the first is the port's own, the others receive broadcasts.
  struct Ear;

  void listen(Ear& ear);
  /// False: the receiver has destroyed the port.
  [[nodiscard]] bool receive_all(Ear& ear);

  UdpPortSettings settings_;
  std::vector<std::unique_ptr<Ear>> ears_;
  unsigned interface_ = 0;  ///< Index of the interface by which broadcasts must arrive.
  std::uint16_t local_port_ = 0;
  bool fragments_ = true;  ///< How the port's own socket is set.
  Receiver receiver_;
  std::vector<std::uint8_t> buffer_;
  std::optional<Clock::time_point> last_received_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
