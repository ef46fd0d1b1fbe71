// What the shaft of a rotary encoder does at one instant.
#pragma once

#include "sim/samples/time.h"

namespace rigwire {

struct EncoderSample {
  SimTime time{};
  /// Not wrapped: a full turn is 2 pi more. Positive counter-clockwise, seen against the axis (for
  /// the swing of an excavator: from above, to the left).
  double angle_rad = 0.0;
  double rate_radps = 0.0;
};

}  // namespace rigwire
