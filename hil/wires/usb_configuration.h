// The keys of a rig's USB/IP server and of its devices' plugs.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/fault_port.h"
#include "hil/wires/usb_bus.h"
#include "protocols/usbip/constants.h"
#include "sim/samples/fault_book.h"

namespace rigwire::hil {

/// One server for all USB devices of a rig; it is started when there is one.
struct UsbConfiguration {
  std::string address = "127.0.0.1";  ///< Numeric IPv4.
  std::uint16_t port = protocols::usbip::kPort;
  bool allow_remote = false;
};

/// Begins the configured faults of a plug, and returns the port for more. `bus` must outlive it.
[[nodiscard]] inline std::unique_ptr<FaultPort> begin_plug_faults(
    const std::vector<PlugFault>& faults, UsbBus& bus, UsbBus::Socket socket) {
  for (const PlugFault& fault : faults) {
    bus.begin(socket, fault);
  }
  return make_fault_port<PlugFault>(
      faults, {[&bus, socket](const PlugFault& fault) { bus.begin(socket, fault); },
               [&bus, socket](std::uint32_t id, SimTime now) { return bus.end(socket, id, now); }});
}

/// Begins the configured faults of the supply of a device that is powered by its plug alone, and
/// returns the port for more. `bus` must outlive it.
[[nodiscard]] inline std::unique_ptr<FaultPort> begin_supply_faults(
    const std::vector<emulators::SupplyFault>& faults, UsbBus& bus, UsbBus::Socket socket) {
  for (const emulators::SupplyFault& fault : faults) {
    bus.begin(socket, fault);
  }
  return make_fault_port<emulators::SupplyFault>(
      faults,
      {[&bus, socket](const emulators::SupplyFault& fault) { bus.begin(socket, fault); },
       [&bus, socket](std::uint32_t id, SimTime now) { return bus.end_outage(socket, id, now); }});
}

inline void visit(fields::Visitor& v, UsbConfiguration& p) {
  v.text("address", p.address, "Where clients attach (usbip attach -r).");
  v.integer("port", p.port, fields::IntegerRule{1, 65535}, "TCP.");
  v.boolean("allow_remote", p.allow_remote, "Opt-in for addresses beyond this machine.");
}

}  // namespace rigwire::hil
