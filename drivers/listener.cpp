#include "drivers/listener.h"

#include "drivers/endpoints.h"

namespace rigwire::drivers {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

std::string mend(const error_code& error, std::uint16_t port) {
  if (error == asio::error::address_in_use) {
    return "another program has the port (ss -ltnp 'sport = :" + std::to_string(port) +
           "' names it); stop it or choose another port";
  }
  if (error == asio::error::access_denied) {
    return "ports below 1024 need CAP_NET_BIND_SERVICE; choose a port from 1024 up, for example " +
           std::to_string(port + 1000);
  }
  if (error == boost::system::errc::address_not_available) {
    return "no interface of this machine has the address (ip addr lists them); use 127.0.0.1";
  }
  return "check address and port";
}

}  // namespace

std::string describe_listener(std::string_view protocol, const std::string& address,
                              std::uint16_t port) {
  const bool v6 = address.find(':') != std::string::npos;
  return std::string(protocol) + " " + (v6 ? "[" + address + "]" : address) + ":" +
         std::to_string(port);
}

std::uint16_t listen(tcp::acceptor& acceptor, std::string_view protocol, const std::string& address,
                     std::uint16_t port, bool allow_remote) {
  const std::string where = describe_listener(protocol, address, port);
  error_code error;
  const auto numeric = asio::ip::make_address(address, error);
  if (error) {
    throw EndpointError(where + ": not a numeric IP address; use for example 127.0.0.1");
  }
  if (!numeric.is_loopback() && !allow_remote) {
    throw EndpointError(where +
                        ": not a loopback address, and others could move the machine; use "
                        "127.0.0.1, or opt in with allow_remote");
  }
  const tcp::endpoint endpoint(numeric, port);
  acceptor.open(endpoint.protocol(), error);
  if (!error) {
    acceptor.set_option(asio::socket_base::reuse_address(true), error);
  }
  if (!error) {
    acceptor.bind(endpoint, error);
  }
  if (!error) {
    acceptor.listen(asio::socket_base::max_listen_connections, error);
  }
  if (error) {
    throw EndpointError(where + ": " + error.message() + "; " + mend(error, port));
  }
  return acceptor.local_endpoint().port();
}

std::uint16_t listen_again(tcp::acceptor& acceptor, KeptListener* kept, std::string_view protocol,
                           const std::string& address, std::uint16_t port, bool allow_remote) {
  const int socket = kept != nullptr ? kept->take() : -1;
  if (socket < 0) {
    return listen(acceptor, protocol, address, port, allow_remote);
  }
  error_code error;
  const bool v4 = asio::ip::make_address(address, error).is_v4();
  acceptor.assign(v4 ? tcp::v4() : tcp::v6(), socket, error);
  if (error) {
    const Descriptor closed(socket);
    throw EndpointError(describe_listener(protocol, address, port) + ": " + error.message());
  }
  return acceptor.local_endpoint().port();
}

}  // namespace rigwire::drivers
