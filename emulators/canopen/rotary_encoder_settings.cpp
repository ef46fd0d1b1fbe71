// Keys and checks of the encoder's settings.
#include <array>

#include "emulators/canopen/rotary_encoder.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::IntegerRule;

namespace {

constexpr std::array<fields::Choice<bool>, 2> kDirections{
    {{false, "clockwise", "Seen against the axis; as delivered by every maker."},
     {true, "counter_clockwise", "The sense of rotation of positive angles."}}};

}  // namespace

void visit(fields::Visitor& v, RotaryEncoderSettings& p) {
  visit_canopen(v, p.node, p.transmission_type, p.event_timer_ms, p.heartbeat_ms, p.serial);
  v.integer("resolution", p.resolution_bits, IntegerRule{13, 16}, "Bits per revolution.");
  v.integer("revolutions", p.revolutions, IntegerRule{1, 32768},
            "Revolutions that it tells apart; 1 = a single-turn encoder.");
  v.choice("direction", p.counter_clockwise, kDirections, "Direction in which the code rises.");
  v.number("offset", p.offset_rad, fields::in("deg").between(-360, 360),
           "Angle at which the code is 0.");
  v.duration("sampling", p.sampling, {100'000, 1'000'000'000},
             "Time between two readings of the disc.");
  visit(v, p.supply);
}

void validate(const RotaryEncoderSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
  validate(settings.node);
}

}  // namespace rigwire::emulators
