// What every fuzzed device on a J1939 bus must keep to, whatever it is sent.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "emulators/device.h"
#include "protocols/can/frame.h"

namespace rigwire::fuzz {

inline void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// Frames leave in order of time and are J1939's.
struct Output final : emulators::FrameOutput {
  void send(SimTime due, const protocols::can::Frame& frame) override {
    require(due >= last);
    last = due;
    require(frame.length <= 8 && frame.extended && frame.id <= 0x1FFFFFFFU);
    ++count;
  }
  SimTime last = kStart;
  std::uint64_t count = 0;
};

}  // namespace rigwire::fuzz
