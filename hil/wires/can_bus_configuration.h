// The CAN buses of a rig: bit rate, queues, faults, and what carries the frames to the client.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "drivers/slcan_adapter.h"
#include "emulators/can/can_bus.h"
#include "fields/visitor.h"
#include "hil/configuration/can_fault.h"

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

/// One CAN bus that devices share.
struct BusConfiguration {
  CanWire wire = CanWire::automatic;
  std::string interface = "vcan0";        ///< SocketCAN.
  std::string path = "/tmp/rigwire/can";  ///< slcan: symbolic link to the pty.
  bool attach = true;                     ///< gs_usb: to this machine's kernel.
  drivers::SlcanDialect slcan_dialect = drivers::SlcanDialect::automatic;
  emulators::CanBusSettings bus;
  emulators::CanQueueOrder order = emulators::CanQueueOrder::fifo;  ///< Of the devices' queues.
  bool one_shot = false;
  bool restarts = true;
  Duration restart_after = std::chrono::milliseconds{100};
  bool acknowledger = true;
  bool duplicate_addresses = false;
  std::vector<CanFaultConfiguration> faults;
};

inline void visit(fields::Visitor& v, BusConfiguration& p) {
  v.choice("wire", p.wire, kCanWires, "What carries the frames.");
  v.text("interface", p.interface, "socketcan: the interface's name.");
  v.text("path", p.path, "slcan: symbolic link to the pty, what a client opens.");
  v.boolean("attach", p.attach,
            "gs_usb: attach the adapter to this machine's kernel where that is permitted.");
  v.choice("slcan_dialect", p.slcan_dialect, kSlcanDialects, "What a slcan client is told.");
  visit(v, p.bus);
  v.choice("order", p.order, emulators::kCanQueueOrders,
           "Which waiting frame a device sends next.");
  v.boolean("one_shot", p.one_shot, "Devices try every frame once only.");
  v.boolean("restarts", p.restarts, "Controllers come back from bus-off by themselves.");
  v.duration("restart_after", p.restart_after, {0, 3'600'000'000'000},
             "From bus-off to the beginning of the recovery.");
  v.boolean("acknowledger", p.acknowledger,
            "A further node acknowledges, as the rest of a machine does; without it a device that "
            "is alone repeats its first frame until a client comes.");
  v.boolean("duplicate_addresses", p.duplicate_addresses,
            "Devices may be set to one and the same J1939 address and settle it themselves.");
  v.list("faults", p.faults, "What goes wrong on the bus, and when.");
}

inline void validate(const BusConfiguration& p) {
  validate(p.bus);
}

}  // namespace rigwire::hil
