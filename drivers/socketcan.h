// A CAN interface of the kernel (vcan0, can0), by a raw socket. Used by both sides.
//
// Receives every data and remote frame that others put on the interface, this host's other programs
// included, own frames not. Error frames and CAN FD frames are not taken. On vcan the kernel drops
// silently at a receiver that does not read; frames lost so are counted where the kernel says so.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

/// Whether the kernel has CAN sockets at all. With an interface name: whether that exists too.
[[nodiscard]] bool socketcan_available();
[[nodiscard]] bool socketcan_available(const std::string& interface);

class SocketCanBus final : public CanBus {
 public:
  /// Throws EndpointError when the kernel has no CAN, the interface is missing, is no CAN
  /// interface, or is down; the message says how to make one.
  SocketCanBus(boost::asio::io_context& context, std::string interface);
  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  void start(Receiver receiver) override;
  /// False when the interface's queue is full (ENOBUFS) or it went down.
  bool send(const protocols::can::Frame& frame) override;
  /// client_present: a frame of somebody else has arrived.
  [[nodiscard]] EndpointStatus status() const override;

  /// Frames that the kernel dropped because this socket's buffer was full.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  void wait_readable();
  /// False when the socket is broken for good.
  bool read_all();

  std::string interface_;
  boost::asio::posix::stream_descriptor socket_;
  Receiver receiver_;
  bool heard_ = false;
  std::uint32_t dropped_ = 0;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
