// What servers on TCP have in common: binding, with an error message that helps.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <string>
#include <string_view>

namespace rigwire::drivers {

/// "tcp 127.0.0.1:1502", "http [::1]:8080".
[[nodiscard]] std::string describe_listener(std::string_view protocol, const std::string& address,
                                            std::uint16_t port);

/// Binds and listens; returns the port, which the system chose if `port` is 0. Throws EndpointError
/// when the system refuses (port taken, no permission, no such address), when `address` is no
/// numeric one, or when it is not loopback without `allow_remote`.
std::uint16_t listen(boost::asio::ip::tcp::acceptor& acceptor, std::string_view protocol,
                     const std::string& address, std::uint16_t port, bool allow_remote);

}  // namespace rigwire::drivers
