// The last hop of a CAN bus: what carries its frames from the bus model to the client.
#pragma once

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can_interface.h"
#include "drivers/endpoints.h"
#include "drivers/socketcand_server.h"
#include "hil/wires/can_bus_configuration.h"
#include "hil/wires/usb_bus.h"

namespace rigwire::hil {

/// What a host offers for CAN.
struct CanHost {
  bool sockets = false;  ///< The kernel has CAN sockets.
  std::vector<drivers::CanInterface> interfaces;
  std::string gs_usb_obstacle;  ///< Why no gs_usb adapter can be attached; empty: one can.
};

[[nodiscard]] CanHost examine_can_host();

/// A wire and why it was taken, for people: "vcan0 exists".
struct CanWireChoice {
  CanWire wire = CanWire::slcan;
  std::string why;
};

/// `wire: auto` takes the first of: the SocketCAN interface of the configuration, if it exists, is
/// up, and is virtual or has the bus's bit rate; gs_usb; slcan. Everything else is taken as it is
/// written. The reason names what was in the way of the better ones.
[[nodiscard]] CanWireChoice choose_can_wire(const BusConfiguration& configuration,
                                            const CanHost& host);

/// One open way to clients; owns what it has opened.
struct CanPort {
  std::unique_ptr<drivers::ByteStream> line;      ///< Below slcan; else null.
  std::unique_ptr<drivers::StreamServer> server;  ///< Below socketcand; else null.
  std::unique_ptr<drivers::SocketcandBeacon> beacon;
  std::unique_ptr<drivers::CanBus> endpoint;
  /// The endpoint knows whether a client is there (CanBus::on_client).
  bool client_is_known = false;
};

/// An open hop: the first way to a client, and the further ports of the bus.
struct CanHop : CanPort {
  struct Further : CanPort {
    std::string node;  ///< Name of its node in the bus model.
  };
  CanWireChoice choice;
  std::vector<Further> further;
};

/// Throws drivers::EndpointError (environment), std::invalid_argument (an interface of another bit
/// rate).
/// `usb` gives the rig's USB bus, for gs_usb; the hop must outlive it. Without one there is no
/// gs_usb. `name`: of the bus; `epoch`: time since 1970 at the start of the run, for stamps.
[[nodiscard]] CanHop open_can_hop(const std::string& name, const BusConfiguration& configuration,
                                  const CanHost& host, boost::asio::io_context& io,
                                  std::chrono::microseconds epoch = {},
                                  const std::function<UsbBus&()>& usb = {});

}  // namespace rigwire::hil
