// The datagram by which a socketcand makes itself known: every three seconds to UDP port 42000 of
// its network's broadcast address.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace rigwire::drivers {

class SocketcandBeacon {
 public:
  static constexpr std::chrono::seconds kPeriod{3};

  /// Of a server at `address`, a numeric IPv4 address of this machine, and `port`. Throws
  /// EndpointError. What the system does not send is not sent.
  SocketcandBeacon(boost::asio::io_context& context, const std::string& address, std::uint16_t port,
                   const std::vector<std::string>& buses);

 private:
  void send();

  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint everybody_;
  boost::asio::steady_timer timer_;
  std::string text_;
  std::shared_ptr<char> alive_ = std::make_shared<char>();
};

}  // namespace rigwire::drivers
