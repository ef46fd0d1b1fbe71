// The CAN buses of a rig: bit rate, queues, faults, and what carries the frames to the client.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "drivers/slcan_adapter.h"
#include "emulators/can/can_bus.h"
#include "fields/visitor.h"
#include "hil/configuration/fault_window.h"
#include "hil/wires/line_ports.h"

namespace rigwire::hil {

enum class CanWire { automatic, socketcan, gs_usb, slcan };
inline constexpr std::array<fields::Choice<CanWire>, 4> kCanWires{
    {{CanWire::automatic, "auto",
      "The best that the host offers: the SocketCAN interface where it exists, else gs_usb where "
      "the rig may attach it, else slcan."},
     {CanWire::socketcan, "socketcan", "The kernel's CAN interface."},
     {CanWire::gs_usb, "gs_usb", "A USB adapter that the kernel makes a CAN interface of."},
     {CanWire::slcan, "slcan", "The slcan text protocol on a pty."}}};

inline constexpr std::array<fields::Choice<drivers::SlcanDialect>, 3> kSlcanDialects{
    {{drivers::SlcanDialect::automatic, "auto",
      "The kernel's while its slcan driver is attached to the pty, else LAWICEL's."},
     {drivers::SlcanDialect::kernel, "kernel", "With lines for states and errors."},
     {drivers::SlcanDialect::lawicel, "lawicel", "States and errors only when asked by F."}}};

/// The daemon socketcand on a further node of the bus: CAN over TCP for any number of programs.
struct SocketcandConfiguration {
  std::uint16_t port = 0;  ///< 0: none.
  std::string address = "127.0.0.1";
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  bool beacon = false;
  std::uint32_t error_mask = 0;
};

inline void visit(fields::Visitor& v, SocketcandConfiguration& p) {
  v.integer("port", p.port, fields::IntegerRule{0, 65535},
            "TCP port; 0 = no server. The daemon's own is 29536.");
  v.only_if(p.port != 0, "port", "a port", [&p](fields::Visitor& w) {
    w.text("address", p.address, "Address at which it listens.");
    w.boolean("allow_remote", p.allow_remote, "Permits listening where other machines reach it.");
    w.boolean("beacon", p.beacon, "Makes itself known by a datagram to UDP port 42000.");
    w.integer("error_mask", p.error_mask, fields::IntegerRule{0, 0x1FFF'FFFF},
              "Classes of error frames that clients receive, numbered as in the kernel; 0 = none.");
  });
}

/// One CAN bus that devices share.
struct BusConfiguration {
  CanWire wire = CanWire::automatic;
  std::string interface = "vcan0";        ///< SocketCAN.
  std::string path = "/tmp/rigwire/can";  ///< slcan: symbolic link to the pty.
  unsigned ports = 1;                     ///< slcan.
  SocketcandConfiguration socketcand;
  bool attach = true;  ///< gs_usb: to this machine's kernel.
  drivers::SlcanDialect slcan_dialect = drivers::SlcanDialect::automatic;
  emulators::CanBusSettings bus;
  /// Order of the devices' transmit queues.
  emulators::CanQueueOrder order = emulators::CanQueueOrder::fifo;
  bool one_shot = false;
  bool restarts = true;
  Duration restart_after = std::chrono::milliseconds{100};
  bool acknowledger = true;
  bool duplicate_addresses = false;
  std::vector<emulators::CanFault> faults;
};

inline void visit(fields::Visitor& v, BusConfiguration& p) {
  v.choice("wire", p.wire, kCanWires, "What carries the frames.");
  const auto may_be = [&p](CanWire wire) { return p.wire == wire || p.wire == CanWire::automatic; };
  v.only_if(
      may_be(CanWire::socketcan), "wire", "wire: socketcan or auto",
      [&p](fields::Visitor& w) { w.text("interface", p.interface, "The interface's name."); });
  v.only_if(may_be(CanWire::slcan), "wire", "wire: slcan or auto", [&p](fields::Visitor& w) {
    w.text("path", p.path, "Symbolic link to the pty, what a client opens.");
    w.integer("ports", p.ports, kPorts,
              "Ports of the bus, `path`, `path.1` ...: each a separate node for a separate "
              "program. A SocketCAN interface takes any number of programs as it is.");
    w.choice("slcan_dialect", p.slcan_dialect, kSlcanDialects,
             "What the adapter answers to a client.");
  });
  v.only_if(may_be(CanWire::gs_usb), "wire", "wire: gs_usb or auto", [&p](fields::Visitor& w) {
    w.boolean("attach", p.attach,
              "Attach the adapter to this machine's kernel where that is permitted.");
  });
  v.section("socketcand", p.socketcand, "The bus on TCP, beside whatever else carries it.");
  visit(v, p.bus);
  v.choice("order", p.order, emulators::kCanQueueOrders,
           "Order in which a device sends its waiting frames.");
  v.boolean("one_shot", p.one_shot, "Devices try every frame once only.");
  v.boolean("restarts", p.restarts, "Controllers come back from bus-off by themselves.");
  v.only_if(p.restarts, "restarts", "restarts: true", [&p](fields::Visitor& w) {
    w.duration("restart_after", p.restart_after, {0, 3'600'000'000'000},
               "From bus-off to the beginning of the recovery.");
  });
  v.boolean("acknowledger", p.acknowledger,
            "A further node acknowledges, as the rest of a machine does; without it a device that "
            "is alone repeats its first frame until a client comes.");
  v.boolean("duplicate_addresses", p.duplicate_addresses,
            "Devices may be set to one and the same J1939 address and settle it themselves.");
  v.list("faults", p.faults, "What goes wrong on the bus, and when.");
}

inline void validate(const BusConfiguration& p) {
  validate(p.bus);
  validate(emulators::CanBusFaults{p.faults});
}

/// What a fault is called, with its node: "unplugged imu".
[[nodiscard]] inline std::string can_fault_name(const emulators::CanFault& fault) {
  const std::string node = emulators::node_of(fault);
  return node.empty() ? kind_name(fault) : kind_name(fault) + " " + node;
}

/// The node of a further slcan port, 1 .. ports - 1, and of the socketcand, as faults know them.
[[nodiscard]] inline std::string client_node(unsigned port) {
  return port_path(std::string(emulators::kCanOutsideName), port);
}
inline constexpr const char* kSocketcandNode = "client.socketcand";

}  // namespace rigwire::hil
