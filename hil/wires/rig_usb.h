// The rig's USB/IP server at run time: the exported devices, their clients, and the plugs that are
// pulled during the run.
#pragma once

#include <boost/asio/io_context.hpp>
#include <map>

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
  FaultBook<PlugFault>::Id begin(Socket socket, const PlugFault& fault) override;
  bool end(Socket socket, FaultBook<PlugFault>::Id id, SimTime now) override;
  FaultBook<emulators::SupplyFault>::Id begin(Socket socket,
                                              const emulators::SupplyFault& fault) override;
  bool end_outage(Socket socket, FaultBook<emulators::SupplyFault>::Id id, SimTime now) override;
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
  struct Plug {
    FaultBook<PlugFault> faults;
    FaultBook<emulators::SupplyFault> outages;
    bool out = false;  ///< Unplugged, or without supply.
    SimTime next_change = kNever;
  };
  void find_next_change(Plug& plug) const;

  Executive& executive_;
  drivers::TcpServer endpoint_;
  Output output_;
  emulators::UsbipServer server_;
  std::map<Socket, Plug> plugs_;
  SimTime advanced_ = kStart;
};

}  // namespace rigwire::hil
