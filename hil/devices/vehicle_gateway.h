// The vehicle gateway of a rig: its bus, its node, what it knows of its machine and how long it
// waits for commands.
#pragma once

#include <array>
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

}  // namespace rigwire::hil

namespace rigwire::emulators {

inline constexpr std::array<fields::Choice<emulators::SteeringLayout>, 3> kSteeringLayouts{
    {{emulators::SteeringLayout::front_only, "front_only", "The front axle steers."},
     {emulators::SteeringLayout::counter, "counter", "Both axles, also against each other."},
     {emulators::SteeringLayout::crab, "crab", "Both axles, against each other and alike."}}};

inline void visit(fields::Visitor& v, emulators::VehicleTimeouts& p) {
  constexpr fields::DurationRule kRule{10'000'000, 10'000'000'000};
  v.duration("engine", p.engine, kRule, "TSC1: the engine idles.");
  v.duration("gearbox", p.gearbox, kRule, "TC1: gear and locks stay.");
  v.duration("brake", p.brake, kRule, "XBR: the brake is released.");
  v.duration("guidance", p.guidance, kRule, "Guidance command: steering stays where it is.");
  v.duration("speed", p.speed, kRule, "Machine selected speed command: travel speed 0.");
}

}  // namespace rigwire::emulators

namespace rigwire::hil {

inline void visit(fields::Visitor& v, VehicleGatewayConfiguration& p) {
  emulators::VehicleGatewaySettings& g = p.gateway;
  v.text("bus", p.bus, "One of the rig's buses.");
  v.text("position_from", p.position_from,
         "The satellite receiver whose fixes it reports (VP, VDS, VP2, GBSD); empty = none.");
  v.integer("source_address", g.source_address, fields::IntegerRule{0, 253},
            "Preferred J1939 address.");
  v.integer("serial", g.serial, fields::IntegerRule{1, (1 << 21) - 1},
            "In the NAME; unique on a bus.");
  v.integer("manufacturer", g.manufacturer, fields::IntegerRule{0, 2047}, "In the NAME.");
  v.integer("function", g.function, fields::IntegerRule{0, 255}, "In the NAME.");
  v.boolean("arbitrary_address", g.arbitrary_address,
            "Takes another address when it loses its own; else it falls silent.");
  v.duration("power_on", g.power_on, {0, 86'400'000'000'000}, "From the start of the run.");
  v.duration("sensor_start_up", g.sensor_start_up, {0, 3'600'000'000'000},
             "From power-on to the first reading; not available until then.");
  v.duration("processing_delay", g.processing_delay, {0, 5'000'000}, "From an event to the frame.");
  v.text("make", g.make, "Answer to requests for component identification.");
  v.text("model", g.model, "The same.");
  v.text("unit_number", g.unit_number, "The same.");
  v.text("software", g.software, "Answer to requests for software identification.");
  v.duration("engine_hours", g.engine_hours, {0, 720'000'000'000'000'000},
             "Of the engine when the run begins.");
  v.integer("gears_forward", g.gears_forward, fields::IntegerRule{0, 125},
            "Gears that may be asked for.");
  v.integer("gears_reverse", g.gears_reverse, fields::IntegerRule{0, 125},
            "Gears that may be asked for.");
  v.choice("steering", g.steering, emulators::kSteeringLayouts, "Which axles or drums steer.");
  v.number("wheelbase", g.wheelbase_m, fields::in("m").between(0.1, 100),
           "Axle to axle, or drum to drum; turns curvature into steering angles.");
  v.number("maximum_front_steer", g.maximum_front_steer_rad, fields::in("deg").between(0.1, 89.9),
           "Of the equivalent single wheel or the drum.");
  v.number("maximum_rear_steer", g.maximum_rear_steer_rad, fields::in("deg").between(0.1, 89.9),
           "Of the equivalent single wheel or the drum.");
  v.number("steering_ratio", g.steering_ratio, fields::plain().between(0.1, 100),
           "Steering wheel to equivalent wheel; reported only.");
  v.number("maximum_speed", g.maximum_speed_mps, fields::in("m/s").between(0, 64.255),
           "Speed commands are limited to it.");
  v.number("maximum_reverse_speed", g.maximum_reverse_speed_mps,
           fields::in("m/s").between(0, 64.255), "Speed commands in reverse are limited to it.");
  v.number("full_brake_deceleration", g.full_brake_deceleration_mps2,
           fields::in("m/s2").between(0.1, 15), "Request for which the brake is fully applied.");
  v.number("minimum_tyre_pressure", g.minimum_tyre_pressure_pa, fields::in("kPa").between(0, 2000),
           "Set points below it are refused.");
  v.number("maximum_tyre_pressure", g.maximum_tyre_pressure_pa, fields::in("kPa").between(0, 2000),
           "Set points above it are refused.");
  v.number("maximum_spreader_rate", g.maximum_spreader_rate_kgpm2,
           fields::plain().between(0, 64.255), "kg/m2.");
  v.section("timeouts", g.timeouts, "Commands count for so long; silence does this:");
  v.boolean("stop_without_guidance", g.stop_without_guidance,
            "Losing guidance while it steers stops the machine.");
  v.number("stop_brake_share", g.stop_brake_share, fields::plain().between(0, 1),
           "Of the service brake, when the machine stops by itself.");
  v.number("standstill_speed", g.standstill_speed_mps, fields::in("m/s").between(0.001, 1),
           "Below it the machine stands.");
  v.duration("park_delay", g.park_delay, {0, 3'600'000'000'000},
             "After a stop by itself and standing for this long it parks.");
}

inline void validate(const VehicleGatewayConfiguration& p) {
  emulators::validate(p.gateway);
}

}  // namespace rigwire::hil
