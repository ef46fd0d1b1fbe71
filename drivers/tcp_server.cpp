#include "drivers/tcp_server.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "drivers/endpoint_news.h"
#include "drivers/listener.h"

namespace rigwire::drivers {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// What the system may hold for a client beside the backlog, bytes; Linux doubles it.
constexpr int kSystemBuffer_bytes = 128 << 10U;

/// A vanished peer is found out after 10 s + 4 * 5 s.
void set_keep_alive(tcp::socket& socket) {
  error_code ignored;
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  const auto set = [&](int option, int value) {
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value);
  };
  set(TCP_KEEPIDLE, 10);
  set(TCP_KEEPINTVL, 5);
  set(TCP_KEEPCNT, 4);
}

}  // namespace

struct TcpServer::State : Listening, std::enable_shared_from_this<State> {
  struct Client {
    Client(ConnectionId number, tcp::socket accepted) : id(number), socket(std::move(accepted)) {}
    ConnectionId id;
    tcp::socket socket;
    std::array<std::uint8_t, 4096> incoming{};
    std::vector<std::uint8_t> waiting;  ///< Not yet given to the system.
    std::vector<std::uint8_t> leaving;  ///< Being written.
    bool closing = false;               ///< Ends when everything has left.
    bool held = false;                  ///< Is read from when everything has left.
    bool ended = false;
    std::chrono::steady_clock::time_point heard = std::chrono::steady_clock::now();
  };
  using ClientPointer = std::shared_ptr<Client>;

  State(asio::io_context& context, TcpServerSettings wanted)
      : Listening(context), settings(std::move(wanted)), news(endpoint_news(context)) {}

  TcpServerSettings settings;
  Handler handler;
  std::vector<ClientPointer> clients;
  ConnectionId next_id = 1;
  EndpointNews& news;
  std::uint64_t cut_off = 0;

  ClientPointer find(ConnectionId id) const {
    const auto found = std::ranges::find(clients, id, [](const auto& c) { return c->id; });
    return found == clients.end() ? nullptr : *found;
  }

  void admit(tcp::socket socket) {
    if (clients.size() >= settings.clients_max) {
      end(*std::ranges::min_element(clients, {}, [](const auto& c) { return c->heard; }));
    }
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(kSystemBuffer_bytes), ignored);
    socket.non_blocking(true, ignored);
    set_keep_alive(socket);
    auto client = std::make_shared<Client>(next_id++, std::move(socket));
    clients.push_back(client);
    if (handler.connected) {
      handler.connected(client->id);
    }
    read(client);
  }

  void read(const ClientPointer& client) {
    if (client->ended) {
      return;
    }
    client->held = !client->leaving.empty();
    if (client->held) {
      return;
    }
    client->socket.async_read_some(
        asio::buffer(client->incoming),
        [self = shared_from_this(), client](const error_code& error, std::size_t size) {
          if (client->ended || self->stopped) {
            return;
          }
          if (error == asio::error::eof) {
            self->half_close(client);
            return;
          }
          if (error) {
            self->end(client);
            return;
          }
          client->heard = std::chrono::steady_clock::now();
          if (!client->closing && self->handler.received) {
            self->handler.received(client->id, std::span(client->incoming).first(size));
          }
          self->read(client);
        });
  }

  /// The client has closed its sending half, or both: which one is seen when something is sent.
  void half_close(const ClientPointer& client) {
    if (!client->closing && handler.half_closed) {
      handler.half_closed(client->id);
    } else {
      close(client);
    }
  }

  void close(const ClientPointer& client) {
    client->closing = true;
    if (client->leaving.empty()) {
      end(client);
    }
  }

  bool send(const ClientPointer& client, std::span<const std::uint8_t> bytes) {
    if (client->closing || client->ended) {
      return false;
    }
    if (client->leaving.empty()) {
      error_code error;
      const std::size_t size =
          client->socket.write_some(asio::buffer(bytes.data(), bytes.size()), error);
      if (error && error != asio::error::would_block) {
        end(client);
        return false;
      }
      bytes = bytes.subspan(size);
    }
    if (bytes.empty()) {
      return true;
    }
    const std::size_t backlog = client->waiting.size() + client->leaving.size();
    if (backlog + bytes.size() > settings.backlog_bytes) {
      if (++cut_off == 1) {
        news.report(describe_listener("tcp", settings.address, settings.port) +
                    ": closed a client that does not read: " + std::to_string(backlog) +
                    " bytes waited for it, allowed " + std::to_string(settings.backlog_bytes) +
                    "; further ones are counted only");
      }
      end(client);
      return false;
    }
    client->waiting.insert(client->waiting.end(), bytes.begin(), bytes.end());
    write(client);
    return true;
  }

  void write(const ClientPointer& client) {
    if (!client->leaving.empty() || client->waiting.empty()) {
      return;
    }
    std::swap(client->leaving, client->waiting);
    asio::async_write(client->socket, asio::buffer(client->leaving),
                      [self = shared_from_this(), client](const error_code& error, std::size_t) {
                        if (client->ended || self->stopped) {
                          return;
                        }
                        client->leaving.clear();
                        if (error || (client->closing && client->waiting.empty())) {
                          self->end(client);
                          return;
                        }
                        self->write(client);
                        if (client->held) {
                          self->read(client);
                        }
                      });
  }

  /// Ends a connection now; calls the handler's `disconnected` later, from the io_context.
  void end(ClientPointer client) {
    if (client->ended) {
      return;
    }
    client->ended = true;
    error_code ignored;
    client->socket.shutdown(tcp::socket::shutdown_both, ignored);
    client->socket.close(ignored);
    std::erase(clients, client);
    asio::post(acceptor.get_executor(), [self = shared_from_this(), id = client->id] {
      if (!self->stopped && self->handler.disconnected) {
        self->handler.disconnected(id);
      }
    });
  }
};

TcpServer::TcpServer(asio::io_context& context, const TcpServerSettings& settings) {
  check_setting<std::size_t>("tcp server", "clients_max", settings.clients_max, 1, 1024);
  check_setting<std::size_t>("tcp server", "backlog_bytes", settings.backlog_bytes, 1024,
                             std::size_t{16} << 20U);
  state_ = std::make_shared<State>(context, settings);
  state_->settings.port =
      listen(state_->acceptor, "tcp", settings.address, settings.port, settings.allow_remote);
}

TcpServer::~TcpServer() {
  state_->stop();
  state_->handler = {};
  error_code ignored;
  for (const auto& client : state_->clients) {
    client->ended = true;
    client->socket.shutdown(tcp::socket::shutdown_both, ignored);
    client->socket.close(ignored);
  }
  state_->clients.clear();
}

void TcpServer::start(Handler handler) {
  state_->handler = std::move(handler);
  accept_clients(state_);
}

bool TcpServer::send(ConnectionId connection, std::span<const std::uint8_t> bytes) {
  const auto client = state_->find(connection);
  return client != nullptr && state_->send(client, bytes);
}

void TcpServer::close(ConnectionId connection) {
  const auto client = state_->find(connection);
  if (client != nullptr) {
    state_->close(client);
  }
}

EndpointStatus TcpServer::status() const {
  EndpointStatus status{describe_listener("tcp", state_->settings.address, state_->settings.port),
                        !state_->clients.empty()};
  status.cut_off = state_->cut_off;
  return status;
}

IpEnd TcpServer::end() const {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address_v4(state_->settings.address, error);
  return error ? IpEnd{} : IpEnd{address.to_uint(), state_->settings.port};
}

std::uint16_t TcpServer::port() const {
  return state_->settings.port;
}

std::size_t TcpServer::clients() const {
  return state_->clients.size();
}

}  // namespace rigwire::drivers
