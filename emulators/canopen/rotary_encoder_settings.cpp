// Keys and checks of the encoder's settings.
#include <array>
#include <stdexcept>

#include "emulators/canopen/rotary_encoder.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
using fields::IntegerRule;

namespace {

constexpr std::array<fields::Choice<bool>, 2> kDirections{
    {{false, "clockwise", "Seen against the axis; as delivered by every maker."},
     {true, "counter_clockwise", "The sense of rotation of positive angles."}}};

}  // namespace

void visit(fields::Visitor& v, RotaryEncoderSettings& p) {
  v.integer("node_id", p.node.node_id, IntegerRule{1, canopen::kGreatestNodeId},
            "CANopen node; unique on a bus.");
  v.integer("resolution", p.resolution_bits, IntegerRule{13, 16}, "Bits per revolution.");
  v.integer("revolutions", p.revolutions, IntegerRule{1, 32768},
            "Revolutions that it tells apart; 1 = a single-turn encoder.");
  v.choice("direction", p.counter_clockwise, kDirections, "Direction in which the code rises.");
  v.number("offset", p.offset_rad, fields::in("deg").between(-360, 360),
           "Angle at which the code is 0.");
  v.integer("event_timer", p.event_timer_ms, IntegerRule{0, 65535, fields::unit("ms")},
            "Time between two position messages; 0 = only on SYNC or change.");
  v.integer("transmission_type", p.transmission_type, IntegerRule{0, 255},
            "When the first message is sent: 0 .. 240 after SYNC, 254 timer and change, 255 "
            "timer.");
  v.check(p.transmission_type <= canopen::kGreatestSynchronous ||
              p.transmission_type >= canopen::kOnChange,
          "transmission_type", "reserved by CiA 301", std::to_string(p.transmission_type),
          "0 .. 240, 254, 255");
  v.integer("heartbeat", p.heartbeat_ms, IntegerRule{0, 65535, fields::unit("ms")},
            "Time between two heartbeats; 0 = none.");
  v.boolean("starts_itself", p.node.starts_itself, "Operational without a master's command.");
  v.integer("serial", p.serial, IntegerRule{0, 0xFFFFFFFF},
            "Serial number that its identity object tells.");
  v.duration("sampling", p.sampling, {100'000, 1'000'000'000},
             "Time between two readings of the disc.");
  visit(v, p.supply);
}

void validate(const RotaryEncoderSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
  if (settings.node.boot < Duration{0} || settings.node.processing_delay < Duration{0}) {
    throw std::invalid_argument("CiA 406 encoder: boot and processing_delay must not be negative");
  }
}

}  // namespace rigwire::emulators
