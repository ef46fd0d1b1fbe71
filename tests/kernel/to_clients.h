// Answers of an emulated server go to its clients at once, whatever time they are due.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/endpoints.h"
#include "emulators/device.h"

namespace rigwire {

class ToClients final : public emulators::StreamOutput {
 public:
  explicit ToClients(drivers::StreamServer& server) : server_(server) {}
  void send(emulators::ConnectionId connection, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    server_.send(connection, bytes);
  }
  void close(emulators::ConnectionId connection, SimTime /*due*/) override {
    server_.close(connection);
  }

 private:
  drivers::StreamServer& server_;
};

}  // namespace rigwire
