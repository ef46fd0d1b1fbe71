// A listening TCP socket with its clients, for devices that serve streams (Modbus TCP).
//
// Loopback only, unless the settings opt in to more: a simulated valve must not be reachable from a
// site network by accident. Nagle's delay is off, keep-alive is on (a client that lost power is
// detected after about 30 s). A client that does not read has a bounded backlog; when it is full
// the connection is closed, counted (EndpointStatus::cut_off), and reported the first time
// (drivers/endpoint_news.h). While anything waits for a client, nothing more is read from it: a
// client that keeps asking and takes no answer is held back and costs nothing. A client that closes
// its sending half is still sent what is due to it (StreamServer::Handler::half_closed). When all
// places are taken, a newcomer gets the place of the client that has been silent longest (Modbus
// TCP Implementation Guide V1.0b, section 4.2.2), so that half-open connections cannot lock a
// device.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

struct TcpServerSettings {
  std::string address = "127.0.0.1";  ///< Numeric IPv4 or IPv6.
  std::uint16_t port = 1502;          ///< 0 takes a free one (tests).
  bool allow_remote = false;          ///< Opt-in for addresses other than loopback.
  std::size_t clients_max = 32;       ///< 1 .. 1024.
  std::size_t backlog_bytes = 65536;  ///< Unsent bytes per client, 1024 .. 16 MiB.
};

class TcpServer final : public StreamServer {
 public:
  /// Binds and listens; clients are taken from start() on. Throws std::invalid_argument for a
  /// setting out of range, EndpointError when the system refuses (port taken, no permission, no
  /// such address) or when the address is not loopback without opt-in.
  TcpServer(boost::asio::io_context& context, const TcpServerSettings& settings);
  ~TcpServer() override;

  /// `disconnected` is called for every connection that was announced, whichever side ended it, and
  /// never from within send() or close().
  void start(Handler handler) override;
  bool send(ConnectionId connection, std::span<const std::uint8_t> bytes) override;
  /// What was sent before still leaves.
  void close(ConnectionId connection) override;
  [[nodiscard]] IpEnd end() const override;
  [[nodiscard]] EndpointStatus status() const override;

  /// The port that is bound.
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::size_t clients() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace rigwire::drivers
