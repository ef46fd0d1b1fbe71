// A CANopen rotary encoder: bus, the two links whose angle it reads, and what it is at delivery.
#pragma once

#include <array>
#include <string>

#include "emulators/canopen/rotary_encoder.h"
#include "fields/visitor.h"
#include "hil/configuration/supply.h"

namespace rigwire::hil {

/// Absolute rotary encoder (CANopen, CiA 406) between two links of the machine.
struct EncoderDeviceConfiguration {
  static constexpr fields::Named kNamed{
      "cia406-encoder", "Absolute rotary encoder on CANopen (CiA 406), at a joint."};

  std::string bus = "can";             ///< One of the rig's buses.
  std::string base = "undercarriage";  ///< Link that carries the housing.
  std::string link = "upper";          ///< Link that turns the shaft.
  char axis = 'z';                     ///< Of the base link.
  emulators::RotaryEncoderSettings encoder;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
};

inline constexpr std::array<fields::Choice<char>, 3> kEncoderAxes{
    {{'x', "x", "Forward."}, {'y', "y", "To the left."}, {'z', "z", "Up."}}};
inline constexpr std::array<fields::Choice<bool>, 2> kEncoderDirections{
    {{false, "clockwise", "Seen against the axis; as delivered by every maker."},
     {true, "counter_clockwise", "The sense of rotation of positive angles."}}};

inline void visit(fields::Visitor& v, EncoderDeviceConfiguration& p) {
  emulators::RotaryEncoderSettings& e = p.encoder;
  v.text("bus", p.bus, "One of the rig's buses.");
  v.integer("node_id", e.node.node_id, fields::IntegerRule{1, 127}, "CANopen; unique on a bus.");
  v.text("base", p.base, "Link of the machine that carries the housing.");
  v.text("link", p.link, "Link of the machine that turns the shaft.");
  v.choice("axis", p.axis, kEncoderAxes, "Of the base link, about which the shaft turns.");
  v.integer("resolution", e.resolution_bits, fields::IntegerRule{13, 16}, "Bits per revolution.");
  v.integer("revolutions", e.revolutions, fields::IntegerRule{1, 32768},
            "Told apart; 1 is single-turn.");
  v.choice("direction", e.counter_clockwise, kEncoderDirections, "In which the code rises.");
  v.number("offset", e.offset_rad, fields::in("deg").between(-360, 360),
           "Angle at which the code is 0.");
  v.integer("event_timer", e.event_timer_ms, fields::IntegerRule{0, 65535},
            "ms between two position messages; 0: only on SYNC or change.");
  v.integer("transmission_type", e.transmission_type, fields::IntegerRule{0, 255},
            "Of the first message: 0..240 after SYNC, 254 timer and change, 255 timer.");
  v.integer("heartbeat", e.heartbeat_ms, fields::IntegerRule{0, 65535}, "ms; 0: none.");
  v.boolean("starts_itself", e.node.starts_itself, "Operational without a master's command.");
  v.integer("serial", e.serial, fields::IntegerRule{0, 0xFFFFFFFF}, "As its identity says.");
  v.duration("sampling", e.sampling, {100'000, 1'000'000'000}, "Between two readings of the disc.");
  visit_supply(v, e.supply);
  v.text("settings_file", p.settings_file,
         "What a client saved, for the next run; empty: as long as the run.");
}

inline void validate(const EncoderDeviceConfiguration& p) {
  validate(p.encoder);
}

}  // namespace rigwire::hil
