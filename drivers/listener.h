// Common parts of TCP servers: binding, with an error message that helps, and accepting clients.
#pragma once

#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

/// "tcp 127.0.0.1:1502", "http [::1]:8080".
[[nodiscard]] std::string describe_listener(std::string_view protocol, const std::string& address,
                                            std::uint16_t port);

/// Binds and listens; returns the port, which the system chose if `port` is 0. Throws EndpointError
/// when the system refuses (port taken, no permission, no such address), when `address` is no
/// numeric one, or when it is not loopback without `allow_remote`.
std::uint16_t listen(boost::asio::ip::tcp::acceptor& acceptor, std::string_view protocol,
                     const std::string& address, std::uint16_t port, bool allow_remote);

/// Throws std::invalid_argument unless the setting of that server lies between.
template <class Number>
void check_setting(const char* server, const char* setting, Number value, Number lower,
                   Number upper) {
  if (value < lower || value > upper) {
    throw std::invalid_argument(std::string(server) + " " + setting + ": found " +
                                std::to_string(value) + ", allowed " + std::to_string(lower) +
                                " .. " + std::to_string(upper));
  }
}

/// A listening socket between two servers at one port: the port stays this program's, and clients
/// that connect meanwhile wait for the next server. Belongs to one thread at a time.
class KeptListener {
 public:
  KeptListener() = default;
  ~KeptListener() { keep(-1); }
  KeptListener(const KeptListener&) = delete;
  KeptListener& operator=(const KeptListener&) = delete;

  /// Owns `socket` from now on, in place of the one before.
  void keep(int socket) { const Descriptor before(std::exchange(socket_, socket)); }
  /// Hands the socket over; negative: there is none.
  [[nodiscard]] int take() { return std::exchange(socket_, -1); }

 private:
  int socket_ = -1;
};

/// Listens on the socket that `kept` has; where it has none, or is null, as listen(). Address and
/// port must be those of the server before.
std::uint16_t listen_again(boost::asio::ip::tcp::acceptor& acceptor, KeptListener* kept,
                           std::string_view protocol, const std::string& address,
                           std::uint16_t port, bool allow_remote);

/// Accepts clients; the base of a server's state, which the handlers that the io_context still
/// holds share when the server is destroyed.
struct Listening {
  explicit Listening(boost::asio::io_context& context) : acceptor(context), retry(context) {}
  /// Accepts no more clients.
  void stop() {
    stopped = true;
    boost::system::error_code ignored;
    if (kept && acceptor.is_open()) {
      kept->keep(acceptor.release(ignored));
    }
    acceptor.close(ignored);
    retry.cancel(ignored);
  }

  /// Calls `then` once after 100 ms, unless stopped before: the system had no descriptors left.
  /// `then` must keep this object alive.
  template <class Then>
  void after_a_while(Then then) {
    retry.expires_after(std::chrono::milliseconds(100));
    retry.async_wait([this, then = std::move(then)](const boost::system::error_code&) {
      if (!stopped) {
        then();
      }
    });
  }

  boost::asio::ip::tcp::acceptor acceptor;
  boost::asio::steady_timer retry;
  std::shared_ptr<KeptListener> kept;  ///< Given the socket at the end; null: it is closed.
  bool stopped = false;
};

/// Hands one client after the other to server->admit(socket), until server->stopped. `Server` is
/// Listening, and is kept alive meanwhile. While the system has no descriptors left, it retries
/// every 100 ms.
template <class Server>
void accept_clients(const std::shared_ptr<Server>& server) {
  server->acceptor.async_accept(
      [server](const boost::system::error_code& error, boost::asio::ip::tcp::socket socket) {
        if (server->stopped || error == boost::asio::error::operation_aborted) {
          return;
        }
        if (!error) {
          server->admit(std::move(socket));
          accept_clients(server);
          return;
        }
        server->after_a_while([server] { accept_clients(server); });
      });
}

}  // namespace rigwire::drivers
