// An emulated CANopen encoder under test.
#pragma once

#include "canopen_rig.h"
#include "emulators/canopen/rotary_encoder.h"

namespace rigwire::emulators {

struct EncoderRig final : CanopenRig<RotaryEncoder> {
  static RotaryEncoderSettings settings() {
    RotaryEncoderSettings settings;
    settings.node.node_id = kNode;
    settings.counter_clockwise = true;
    return settings;
  }
  explicit EncoderRig(const RotaryEncoderSettings& of = settings()) : CanopenRig(of) {}

  void feed(SimTime instant) override { encoder.update({instant, angle_rad, rate_radps}); }

  double angle_rad = 0.0;
  double rate_radps = 0.0;
  RotaryEncoder& encoder = device;
};

}  // namespace rigwire::emulators
