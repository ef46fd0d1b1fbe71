// Outputs that lead nowhere: for an emulator that is only built to be asked what it can say.
#pragma once

#include "emulators/device.h"

namespace rigwire::emulators {

class NullByteOutput final : public ByteOutput {
 public:
  void send(SimTime /*due*/, std::span<const std::uint8_t> /*bytes*/) override {}
};

class NullFrameOutput final : public FrameOutput {
 public:
  void send(SimTime /*due*/, const protocols::can::Frame& /*frame*/) override {}
};

}  // namespace rigwire::emulators
