// The vehicle gateway of a rig: its bus, its node, what it knows of its machine and how long it
// waits for commands.
#pragma once

#include <string>

#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "fields/visitor.h"

namespace rigwire::hil {

/// J1939 node between a field controller and a machine that drives.
struct VehicleGatewayConfiguration {
  std::string bus = "can";    ///< One of the rig's buses.
  std::string position_from;  ///< Name of the satellite receiver wired to it; empty: none.
  emulators::VehicleGatewaySettings gateway;
};

/// What its emulator is made with.
[[nodiscard]] inline emulators::VehicleGatewaySettings settings_of(
    const VehicleGatewayConfiguration& p) {
  emulators::VehicleGatewaySettings settings = p.gateway;
  settings.has_position = !p.position_from.empty();
  return settings;
}

inline void visit(fields::Visitor& v, VehicleGatewayConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  v.text("position_from", p.position_from,
         "The satellite receiver whose fixes it reports (VP, VDS, VP2, GBSD); empty = none.");
  visit(v, p.gateway);
}

inline void validate(const VehicleGatewayConfiguration& p) {
  emulators::validate(p.gateway);
}

}  // namespace rigwire::hil
