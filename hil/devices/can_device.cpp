#include "hil/devices/can_device.h"

#include <fmt/format.h>

#include "fields/visitor.h"

namespace rigwire::hil {

void visit_node(fields::Visitor& v, std::string& bus, emulators::OwnClockSettings& clock) {
  v.text("bus", bus, "Name of the rig's bus that the device is on.");
  v.section("clock", clock, "The device's own clock: how far it runs from the true one.");
}

std::string can_wire(const RigView& rig, const std::string& bus, const std::string& who) {
  const auto found = rig.buses.find(bus);
  return found == rig.buses.end()
             ? bus
             : fmt::format("can {} at {} bit/s, {}", bus, found->second.bus.bit_rate_bps, who);
}

DevicePlan j1939_plan(const RigView& rig, const std::string& bus, unsigned address,
                      double frames_hz, const std::string& with) {
  return {can_wire(rig, bus, fmt::format("address 0x{:02X}", address)),
          fmt::format("{:.0f} frames/s", frames_hz), fmt::format("{:.0f} B/s", frames_hz * 8),
          with};
}

}  // namespace rigwire::hil
