// In-memory twin of TcpServer: the test plays the clients, nothing leaves the process.
//
// Delivery is at once, within the client's call. The limits and their consequences are TcpServer's:
// bounded backlog, bounded clients, the one that has been silent longest makes room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

struct MemoryStreamServerSettings {
  std::size_t clients_max = 32;       ///< At least 1.
  std::size_t backlog_bytes = 65536;  ///< Bytes that a client has not taken, at least 1.
};

class MemoryStreamServer final : public StreamServer {
 public:
  /// Throws std::invalid_argument.
  explicit MemoryStreamServer(const MemoryStreamServerSettings& settings = {});

  void start(Handler handler) override;
  bool send(ConnectionId connection, std::span<const std::uint8_t> bytes) override;
  void close(ConnectionId connection) override;
  [[nodiscard]] EndpointStatus status() const override;

  // The clients' side.
  ConnectionId client_connect();
  /// False when the connection is not open.
  bool client_send(ConnectionId connection, std::span<const std::uint8_t> bytes);
  /// What the server sent since the last call; still readable after a close.
  [[nodiscard]] std::vector<std::uint8_t> client_take(ConnectionId connection);
  void client_close(ConnectionId connection);
  /// The client sends nothing more, and still reads.
  void client_half_close(ConnectionId connection);
  [[nodiscard]] bool open(ConnectionId connection) const;

 private:
  struct Client {
    ConnectionId id = 0;
    bool open = true;
    std::uint64_t heard = 0;
    std::vector<std::uint8_t> unread;
  };

  [[nodiscard]] Client* find(ConnectionId connection);
  void end(Client& client);

  MemoryStreamServerSettings settings_;
  Handler handler_;
  std::vector<Client> clients_;
  std::uint64_t order_ = 0;
};

}  // namespace rigwire::drivers
