#include "memory_stream_server.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rigwire::drivers {

MemoryStreamServer::MemoryStreamServer(const MemoryStreamServerSettings& settings)
    : settings_(settings) {
  if (settings.clients_max < 1 || settings.backlog_bytes < 1) {
    throw std::invalid_argument("memory stream server: clients_max and backlog_bytes must be >= 1");
  }
}

void MemoryStreamServer::start(Handler handler) {
  handler_ = std::move(handler);
}

bool MemoryStreamServer::send(ConnectionId connection, std::span<const std::uint8_t> bytes) {
  Client* client = find(connection);
  if (client == nullptr || !client->open) {
    return false;
  }
  if (client->unread.size() + bytes.size() > settings_.backlog_bytes) {
    end(*client);
    return false;
  }
  client->unread.insert(client->unread.end(), bytes.begin(), bytes.end());
  return true;
}

void MemoryStreamServer::close(ConnectionId connection) {
  if (Client* client = find(connection); client != nullptr && client->open) {
    end(*client);
  }
}

EndpointStatus MemoryStreamServer::status() const {
  return {"memory", std::ranges::any_of(clients_, &Client::open)};
}

StreamServer::ConnectionId MemoryStreamServer::client_connect() {
  if (std::ranges::count_if(clients_, &Client::open) >=
      static_cast<std::ptrdiff_t>(settings_.clients_max)) {
    Client* quietest = nullptr;
    for (Client& client : clients_) {
      if (client.open && (quietest == nullptr || client.heard < quietest->heard)) {
        quietest = &client;
      }
    }
    if (quietest != nullptr) {
      end(*quietest);
    }
  }
  const ConnectionId id = clients_.size() + 1;
  clients_.push_back({id, true, ++order_, {}});
  if (handler_.connected) {
    handler_.connected(id);
  }
  return id;
}

bool MemoryStreamServer::client_send(ConnectionId connection, std::span<const std::uint8_t> bytes) {
  Client* client = find(connection);
  if (client == nullptr || !client->open) {
    return false;
  }
  client->heard = ++order_;
  if (handler_.received) {
    handler_.received(connection, bytes);
  }
  return true;
}

std::vector<std::uint8_t> MemoryStreamServer::client_take(ConnectionId connection) {
  Client* client = find(connection);
  return client == nullptr ? std::vector<std::uint8_t>{} : std::exchange(client->unread, {});
}

void MemoryStreamServer::client_close(ConnectionId connection) {
  close(connection);
}

void MemoryStreamServer::client_half_close(ConnectionId connection) {
  if (open(connection) && handler_.half_closed) {
    handler_.half_closed(connection);
  } else {
    close(connection);
  }
}

bool MemoryStreamServer::open(ConnectionId connection) const {
  return connection >= 1 && connection <= clients_.size() && clients_[connection - 1].open;
}

MemoryStreamServer::Client* MemoryStreamServer::find(ConnectionId connection) {
  return connection >= 1 && connection <= clients_.size() ? &clients_[connection - 1] : nullptr;
}

void MemoryStreamServer::end(Client& client) {
  client.open = false;
  if (handler_.disconnected) {
    handler_.disconnected(client.id);
  }
}

}  // namespace rigwire::drivers
