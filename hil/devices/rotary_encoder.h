// A CANopen rotary encoder: bus, the two links whose angle it reads, and what it is at delivery.
#pragma once

#include <array>
#include <string>

#include "emulators/canopen/rotary_encoder.h"
#include "fields/visitor.h"

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

inline void visit(fields::Visitor& v, EncoderDeviceConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  v.text("base", p.base, "Link of the machine that carries the housing.");
  v.text("link", p.link, "Link of the machine that turns the shaft.");
  v.choice("axis", p.axis, kEncoderAxes, "Of the base link, about which the shaft turns.");
  visit(v, p.encoder);
  v.text("settings_file", p.settings_file,
         "What a client saved, for the next run; empty: as long as the run.");
}

inline void validate(const EncoderDeviceConfiguration& p) {
  validate(p.encoder);
}

}  // namespace rigwire::hil
