#include "hil/wires/can_hop.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"
#include "drivers/socketcan.h"
#include "drivers/socketcand_server.h"
#include "drivers/tcp_server.h"
#include "drivers/terminal.h"
#include "hil/wires/gs_usb_can.h"

namespace rigwire::hil {
namespace {

/// Why the configured interface will not do; empty when it will.
std::string socketcan_obstacle(const BusConfiguration& bus, const CanHost& host) {
  if (!host.sockets) {
    return "the kernel has no CAN sockets";
  }
  const auto found =
      std::find_if(host.interfaces.begin(), host.interfaces.end(),
                   [&bus](const auto& interface) { return interface.name == bus.interface; });
  if (found == host.interfaces.end()) {
    return "there is no interface " + bus.interface;
  }
  if (!found->up) {
    return bus.interface + " is down";
  }
  if (!found->is_virtual() && found->bit_rate_bps != 0 &&
      found->bit_rate_bps != bus.bus.bit_rate_bps) {
    return fmt::format("{} has {} bit/s, the bus {} bit/s", bus.interface, found->bit_rate_bps,
                       bus.bus.bit_rate_bps);
  }
  return {};
}

CanHop open_socketcan(const BusConfiguration& bus, boost::asio::io_context& io) {
  CanHop hop;
  hop.endpoint = std::make_unique<drivers::SocketCanBus>(io, bus.interface, bus.bus.bit_rate_bps);
  return hop;
}

/// Where the adapter cannot be attached here, it is served for others all the same.
CanHop open_gs_usb(const BusConfiguration& bus, const CanHost& host, boost::asio::io_context& io,
                   const std::function<UsbBus&()>& usb) {
  if (!usb) {
    throw drivers::EndpointError(
        "gs_usb: the rig has no USB bus; use `wire: socketcan` or `wire: slcan`");
  }
  GsUsbCanSettings settings;
  settings.attach = bus.attach && host.gs_usb_obstacle.empty();
  CanHop hop;
  hop.endpoint = std::make_unique<GsUsbCan>(io, usb(), settings);
  hop.client_is_known = true;
  return hop;
}

/// Fills in one port.
void open_slcan(CanPort& port, const BusConfiguration& bus, const std::string& path,
                boost::asio::io_context& io) {
  auto pty = std::make_unique<drivers::Pty>(io, path);
  drivers::SlcanAdapterSettings settings;
  settings.bit_rate_bps = bus.bus.bit_rate_bps;
  settings.dialect = bus.slcan_dialect;
  settings.kernel_attached = [line = pty.get()] {
    return drivers::slcan_attached(line->slave_name());
  };
  settings.transmit_queue_frames = bus.bus.queue_frames;
  port.endpoint = std::make_unique<drivers::SlcanAdapter>(*pty, std::move(settings));
  port.line = std::move(pty);
  port.client_is_known = true;
}

CanHop open_slcan(const BusConfiguration& bus, boost::asio::io_context& io) {
  CanHop hop;
  open_slcan(hop, bus, bus.path, io);
  for (unsigned port = 1; port < bus.ports; ++port) {
    CanHop::Further& further = hop.further.emplace_back();
    further.node = client_node(port);
    open_slcan(further, bus, port_path(bus.path, port), io);
  }
  return hop;
}

CanHop::Further open_socketcand(const std::string& name, const BusConfiguration& bus,
                                std::chrono::microseconds epoch, boost::asio::io_context& io) {
  const SocketcandConfiguration& wanted = bus.socketcand;
  drivers::TcpServerSettings listener;
  listener.address = wanted.address;
  listener.port = wanted.port;
  listener.allow_remote = wanted.allow_remote;
  drivers::SocketcandSettings settings;
  settings.buses = {name};
  if (bus.interface != name) {
    settings.buses.push_back(bus.interface);
  }
  settings.epoch = epoch;
  settings.error_mask = wanted.error_mask;
  settings.transmit_queue_frames = bus.bus.queue_frames;
  CanHop::Further port;
  port.node = kSocketcandNode;
  port.server = std::make_unique<drivers::TcpServer>(io, listener);
  if (wanted.beacon) {
    port.beacon = std::make_unique<drivers::SocketcandBeacon>(io, wanted.address, wanted.port,
                                                              settings.buses);
  }
  port.endpoint =
      std::make_unique<drivers::SocketcandServer>(io, *port.server, std::move(settings));
  port.client_is_known = true;
  return port;
}

}  // namespace

CanHost examine_can_host() {
  CanHost host;
  host.sockets = drivers::socketcan_available();
  host.interfaces = drivers::can_interfaces();
  host.gs_usb_obstacle = gs_usb_obstacle();
  return host;
}

CanWireChoice choose_can_wire(const BusConfiguration& configuration, const CanHost& host) {
  if (configuration.wire != CanWire::automatic) {
    return {configuration.wire, "as configured"};
  }
  const std::string no_socketcan = socketcan_obstacle(configuration, host);
  if (no_socketcan.empty()) {
    return {CanWire::socketcan, configuration.interface + " exists"};
  }
  if (configuration.attach && host.gs_usb_obstacle.empty()) {
    return {CanWire::gs_usb, no_socketcan};
  }
  return {CanWire::slcan, fmt::format("{}; {}", no_socketcan, host.gs_usb_obstacle)};
}

CanHop open_can_hop(const std::string& name, const BusConfiguration& configuration,
                    const CanHost& host, boost::asio::io_context& io,
                    std::chrono::microseconds epoch, const std::function<UsbBus&()>& usb) {
  CanHost offered = host;
  if (!usb && offered.gs_usb_obstacle.empty()) {
    offered.gs_usb_obstacle = "the rig has no USB bus";
  }
  CanWireChoice choice = choose_can_wire(configuration, offered);
  CanHop hop;
  switch (choice.wire) {
    case CanWire::socketcan:
      hop = open_socketcan(configuration, io);
      break;
    case CanWire::gs_usb:
      hop = open_gs_usb(configuration, host, io, usb);
      break;
    case CanWire::automatic:
    case CanWire::slcan:
      hop = open_slcan(configuration, io);
      break;
  }
  hop.choice = std::move(choice);
  if (configuration.socketcand.port != 0) {
    hop.further.push_back(open_socketcand(name, configuration, epoch, io));
  }
  return hop;
}

}  // namespace rigwire::hil
