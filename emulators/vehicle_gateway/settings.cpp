#include "emulators/vehicle_gateway/settings.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::in;
using fields::IntegerRule;

namespace {

constexpr std::array<fields::Choice<SteeringLayout>, 3> kSteeringLayouts{
    {{SteeringLayout::front_only, "front_only", "The front axle steers."},
     {SteeringLayout::counter, "counter", "Both axles steer, also against each other."},
     {SteeringLayout::crab, "crab", "Both axles steer, against each other and alike."}}};

constexpr std::array<fields::Choice<DisplayUnits>, 3> kDisplayUnits{
    {{DisplayUnits::metric, "metric", "Metric units."},
     {DisplayUnits::imperial, "imperial", "Imperial units."},
     {DisplayUnits::us, "us", "Units of the United States."}}};

/// Two letters from `first` on: 'a' or 'A'.
void visit_letters(fields::Visitor& v, std::string_view key, std::string& value, char first,
                   std::string_view text) {
  const auto fits = [first](const std::string& letters) {
    return letters.size() == 2 &&
           std::ranges::all_of(letters, [first](char c) { return c >= first && c < first + 26; });
  };
  visit_sendable(v, key, value, text, fits, first == 'a' ? "two small letters" : "two capitals");
}

}  // namespace

void visit(fields::Visitor& v, VehicleTimeouts& p) {
  constexpr fields::DurationRule kRule{10'000'000, 10'000'000'000};
  v.duration("engine", p.engine, kRule, "Without TSC1 for so long the engine idles.");
  v.duration("gearbox", p.gearbox, kRule, "Without TC1 for so long gear and locks stay.");
  v.duration("brake", p.brake, kRule, "Without XBR for so long the brake is released.");
  v.duration("guidance", p.guidance, kRule,
             "Without a guidance command for so long the steering stays where it is.");
  v.duration("speed", p.speed, kRule,
             "Without a machine selected speed command for so long the machine stops.");
  v.duration("implement", p.implement, kRule,
             "Without a hitch and PTO command for so long hitches stop and shafts disengage.");
}

void visit(fields::Visitor& v, VehicleGatewaySettings& p) {
  v.integer("source_address", p.source_address, IntegerRule{0, 253}, "Preferred J1939 address.");
  v.integer("serial", p.serial, IntegerRule{1, (1 << 21) - 1},
            "Identity number in the NAME; unique on a bus.");
  visit(v, p.name);
  v.boolean("arbitrary_address", p.arbitrary_address,
            "Takes another address when it loses its own; else it falls silent.");
  visit(v, p.supply);
  v.duration("sensor_start_up", p.sensor_start_up, {0, 3'600'000'000'000},
             "From power-on to the first reading; not available until then.");
  v.duration("processing_delay", p.processing_delay, {0, 5'000'000},
             "Time from an event to its frame.");
  visit(v, p.identification);
  visit_letters(v, "language", p.language, 'a', "Language that displays shall use, ISO 639.");
  visit_letters(v, "country", p.country, 'A', "Country whose habits displays shall use, ISO 3166.");
  v.choice("units", p.units, kDisplayUnits, "Units that displays shall use.");
  v.duration("key_off", p.key_off, {0, 86'400'000'000'000},
             "When the key is switched off, from the start of the run; 0 s = never.");
  v.duration("maximum_power_time", p.maximum_power_time, {2'000'000'000, 15'000'000'000'000},
             "Longest time that power stays for implements once the key is off.");
  v.duration("engine_hours", p.engine_hours, {0, 720'000'000'000'000'000},
             "Hours of the engine when the run begins.");
  v.integer("gears_forward", p.gears_forward, IntegerRule{0, 125},
            "Forward gears that may be asked for.");
  v.integer("gears_reverse", p.gears_reverse, IntegerRule{0, 125},
            "Reverse gears that may be asked for.");
  v.choice("steering", p.steering, kSteeringLayouts, "Axles or drums that steer.");
  v.number("wheelbase", p.wheelbase_m, in("m").between(0.1, 100),
           "Axle to axle, or drum to drum; turns curvature into steering angles.");
  v.number("maximum_front_steer", p.maximum_front_steer_rad, in("deg").between(0.1, 89.9),
           "Greatest angle of the front's equivalent single wheel, or of the drum.");
  v.number("maximum_rear_steer", p.maximum_rear_steer_rad, in("deg").between(0.1, 89.9),
           "Greatest angle of the rear's equivalent single wheel, or of the drum.");
  v.number("steering_ratio", p.steering_ratio, fields::plain().between(0.1, 100),
           "Angle of the steering wheel per angle of the equivalent wheel; reported only.");
  v.number("maximum_speed", p.maximum_speed_mps, in("m/s").between(0, 64.255),
           "Forward speed commands are limited to it.");
  v.number("maximum_reverse_speed", p.maximum_reverse_speed_mps, in("m/s").between(0, 64.255),
           "Reverse speed commands are limited to it.");
  v.number("full_brake_deceleration", p.full_brake_deceleration_mps2, in("m/s2").between(0.1, 15),
           "Deceleration request for which the brake is fully applied.");
  v.number("minimum_tyre_pressure", p.minimum_tyre_pressure_pa, in("kPa").between(0, 2000),
           "Set points of tyre pressure below it are refused.");
  v.number("maximum_tyre_pressure", p.maximum_tyre_pressure_pa, in("kPa").between(0, 2000),
           "Set points of tyre pressure above it are refused.");
  v.number("maximum_spreader_rate", p.maximum_spreader_rate_kgpm2, in("kg/m2").between(0, 64.255),
           "Set points of the spreader above it are refused.");
  v.section("timeouts", p.timeouts, "How long each command counts, and what silence does.");
  v.boolean("stop_without_guidance", p.stop_without_guidance,
            "Losing guidance while it steers stops the machine.");
  v.number("stop_brake_share", p.stop_brake_share, in("1").between(0, 1),
           "Share of the service brake when the machine stops by itself.");
  v.number("standstill_speed", p.standstill_speed_mps, in("m/s").between(0.001, 1),
           "Speed below which the machine counts as standing still.");
  v.duration("park_delay", p.park_delay, {0, 3'600'000'000'000},
             "After a stop by itself and standing for this long it parks.");
}

void validate(const VehicleGatewaySettings& settings) {
  fields::check(settings);
  validate(settings.supply);
  if (settings.maximum_tyre_pressure_pa < settings.minimum_tyre_pressure_pa) {
    throw std::invalid_argument("vehicle gateway: maximum_tyre_pressure is " +
                                fields::in("kPa").print(settings.maximum_tyre_pressure_pa) +
                                ", allowed is at least minimum_tyre_pressure, " +
                                fields::in("kPa").print(settings.minimum_tyre_pressure_pa));
  }
}

}  // namespace rigwire::emulators
