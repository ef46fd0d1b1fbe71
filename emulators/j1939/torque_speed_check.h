// Whether a torque/speed request (TSC1) counts: by the counter and the checksum that close it.
//
// Source: SAE J1939-71, SPN 4206 and 4207. The counter goes on from message to message of one node;
// one that stands still is the same message again. Ones in both: the sender does not use them.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/can/frame.h"
#include "protocols/vehicle/engine.h"

namespace rigwire::emulators {

class TorqueSpeedCheck {
 public:
  /// `required`: requests that do not use counter and checksum do not count.
  explicit TorqueSpeedCheck(bool required) : required_(required) { counters_.fill(kNone); }

  /// Looks at the next request of the node `source`: the frame, and what it holds.
  [[nodiscard]] bool passes(const protocols::can::Frame& frame,
                            const protocols::vehicle::Tsc1& request, std::uint8_t source);

 private:
  static constexpr std::uint8_t kNone = 0xFF;

  bool required_;
  std::array<std::uint8_t, 256> counters_{};  ///< Last of each node.
};

}  // namespace rigwire::emulators
