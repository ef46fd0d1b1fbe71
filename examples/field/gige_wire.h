// The sockets and the clock of a GigE Vision client (gige_client.h).
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <string>

#include "drivers/udp_socket.h"
#include "field/gige_client.h"

namespace rigwire::field {

class GigeWire {
 public:
  /// `address` of the camera: IPv4, dotted. Throws drivers::EndpointError: no such address, or no
  /// route to it.
  GigeWire(boost::asio::io_context& context, const std::string& address,
           GigeClientSettings settings, std::function<void(const GigeBlock&)> block);
  GigeWire(const GigeWire&) = delete;
  GigeWire& operator=(const GigeWire&) = delete;

  void start();
  /// Releases the camera.
  void stop();

  [[nodiscard]] const GigeClient& client() const { return client_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// After whatever may have changed when the client wants to live next.
  void wait();
  [[nodiscard]] GigeClient::Instant now() const { return Clock::now() - started_; }

  Clock::time_point started_ = Clock::now();
  drivers::UdpSocket control_;
  drivers::UdpSocket stream_;
  GigeClient client_;
  boost::asio::steady_timer timer_;
};

}  // namespace rigwire::field
