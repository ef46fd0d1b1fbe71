#include "hil/control/control_client.h"

#include <fmt/format.h>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

namespace rigwire::hil {

namespace asio = boost::asio;
namespace http = boost::beast::http;

ControlAnswer ask_control(const ControlEndpoint& endpoint, const std::string& token,
                          const std::string& request) {
  const std::string host = endpoint.path.empty()
                               ? fmt::format("{}:{}", endpoint.address, endpoint.port)
                               : std::string("localhost");
  asio::io_context io;
  asio::generic::stream_protocol::socket socket(io);
  try {
    if (endpoint.path.empty()) {
      socket.connect(
          asio::ip::tcp::endpoint(asio::ip::make_address(endpoint.address), endpoint.port));
    } else {
      socket.connect(asio::local::stream_protocol::endpoint(endpoint.path));
    }
    http::request<http::string_body> message(http::verb::post, "/command", 11);
    message.set(http::field::host, host);
    message.set(http::field::connection, "close");
    if (!token.empty()) {
      message.set(http::field::authorization, "Bearer " + token);
    }
    message.body() = request;
    message.prepare_payload();
    http::write(socket, message);
    boost::beast::flat_buffer buffer;
    http::response<http::string_body> response;
    http::read(socket, buffer, response);
    return {static_cast<int>(response.result_int()), response.body()};
  } catch (const boost::system::system_error& error) {
    throw drivers::EndpointError(
        fmt::format("no run answers at {}: {}; start one with rigwire run RIG --control {}",
                    endpoint.path.empty() ? host : "unix:" + endpoint.path, error.code().message(),
                    endpoint.path.empty() ? host : "unix:" + endpoint.path));
  }
}

}  // namespace rigwire::hil
