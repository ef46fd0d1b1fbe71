// The CAN buses of a rig: bit rate, queues, and what carries the frames to the client.
#pragma once

#include <array>
#include <string>

#include "emulators/can/can_bus.h"
#include "hil/configuration/fields.h"

namespace rigwire::hil {

enum class CanWire { automatic, socketcan, slcan };
inline constexpr std::array<Choice<CanWire>, 3> kCanWires{
    {{CanWire::automatic, "auto", "SocketCAN where the interface exists, else slcan."},
     {CanWire::socketcan, "socketcan", "The kernel's CAN interface."},
     {CanWire::slcan, "slcan", "The slcan text protocol on a pty."}}};

/// One CAN bus that devices share.
struct BusConfiguration {
  CanWire wire = CanWire::automatic;
  std::string interface = "vcan0";        ///< SocketCAN.
  std::string path = "/tmp/rigwire/can";  ///< slcan: symbolic link to the pty.
  emulators::CanBusSettings bus;
};

template <class Visitor>
void visit(Visitor& v, BusConfiguration& p) {
  v.choice("wire", p.wire, kCanWires, "What carries the frames.");
  v.text("interface", p.interface, "SocketCAN interface.");
  v.text("path", p.path, "slcan: symbolic link to the pty.");
  v.integer("bitrate", p.bus.bit_rate_bps, IntegerRule{10'000, 1'000'000}, "bit/s.");
  v.integer("queue", p.bus.queue_frames, IntegerRule{1, 65536}, "Frames that a node may hold.");
}

inline void validate(const BusConfiguration& p) {
  validate(p.bus);
}

}  // namespace rigwire::hil
