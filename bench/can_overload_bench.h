// Frames lost on an overloaded CAN bus: by arbitration only those of the least urgent identifiers.
#pragma once

#include <cstdint>
#include <vector>

namespace rigwire::bench {

/// One node, which offers one identifier at one period.
struct CanOverloadNode {
  std::uint32_t id = 0;
  double offered_per_s = 0.0;
  double sent_per_s = 0.0;
  double lost_share = 0.0;  ///< Share of the offered frames that found the queue full.
  /// Longest wait of frames that were sent, from the request to the start of the frame.
  double longest_wait_ms = 0.0;
};

struct CanOverload {
  double offered_load = 0.0;           ///< Bits of all frames offered over the bit rate.
  double bus_load = 0.0;               ///< At the end, over the last second.
  std::vector<CanOverloadNode> nodes;  ///< Most urgent first.
};

/// Eight nodes with eight bytes each at 250 kbit/s, together 1.3 times what the bus carries, for
/// `seconds` of simulated time. Every node has a queue of eight frames.
[[nodiscard]] CanOverload measure_can_overload(int seconds);

}  // namespace rigwire::bench
