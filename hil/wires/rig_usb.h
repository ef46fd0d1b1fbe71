// The rig's USB/IP server at run time: the exported devices, their clients, and the plugs that are
// pulled during the run.
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <vector>

#include "drivers/tcp_server.h"
#include "emulators/usb/usbip_server.h"
#include "hil/executive/event_source.h"
#include "hil/executive/executive.h"
#include "hil/wires/usb_bus.h"
#include "hil/wires/usb_configuration.h"
#include "hil/wires/wire_statistics.h"

namespace rigwire::hil {

/// Answers go to the client at once, not by way of a queue: all of them are due at the instant of
/// what caused them, and a lost one would leave the client's stream without sense. A client that
/// does not read is cut off by the endpoint.
class RigUsb final : public UsbBus, public EventSource {
 public:
  /// Opens the socket and adds itself to the executive, which must outlive it. Throws
  /// drivers::EndpointError.
  RigUsb(const UsbConfiguration& configuration, boost::asio::io_context& io, Executive& executive);

  Socket plug(emulators::UsbDevice& device, std::string_view name) override;
  void set_plugged(SimTime now, Socket socket, bool plugged) override;
  void schedule_unplug(Socket socket, SimTime from, SimTime until) override;
  [[nodiscard]] bool imported(Socket socket) const override { return server_.imported(socket); }
  [[nodiscard]] std::string address(Socket socket) const override;
  [[nodiscard]] SimTime now() const override { return executive_.now(); }

  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  void advance(SimTime now) override;

  [[nodiscard]] std::size_t open_transfers(Socket socket) const {
    return server_.open_transfers(socket);
  }
  [[nodiscard]] std::uint16_t port() const { return endpoint_.port(); }
  [[nodiscard]] const WireStatistics& statistics() const { return output_.statistics; }

 private:
  struct Output final : emulators::StreamOutput {
    explicit Output(drivers::StreamServer& to) : endpoint(to) {}
    void send(emulators::ConnectionId connection, SimTime due,
              std::span<const std::uint8_t> bytes) override;
    void close(emulators::ConnectionId connection, SimTime due) override;
    drivers::StreamServer& endpoint;
    WireStatistics statistics;
  };
  struct PlugChange {
    SimTime time{};
    Socket socket = 0;
    bool plugged = false;
  };

  Executive& executive_;
  drivers::TcpServer endpoint_;
  Output output_;
  emulators::UsbipServer server_;
  std::vector<PlugChange> changes_;  ///< In order of time.
  std::size_t next_change_ = 0;
};

}  // namespace rigwire::hil
