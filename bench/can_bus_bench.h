// What the model of a CAN bus costs, and how exact its times are, on a saturated bus.
#pragma once

#include <cstdint>

namespace rigwire::bench {

struct CanBusCost {
  std::uint64_t frames = 0;
  double frame_ns = 0.0;                ///< CPU time of one frame: queued, arbitrated, delivered.
  double wire_frames_per_s = 0.0;       ///< Frames that the wire can carry, back to back.
  double core_share = 0.0;              ///< Share of one core, for a saturated bus in real time.
  double failed_attempt_ns = 0.0;       ///< CPU time of an attempt that is not acknowledged.
  double worst_arrival_error_ns = 0.0;  ///< Against whole bits from the first edge, rounded once.
};

/// At 1 Mbit/s, ten nodes with a full queue each and frames of 0 .. 8 random bytes, stepped event
/// by event as the executive does. `frames` at least 1.
[[nodiscard]] CanBusCost measure_can_bus(std::uint64_t frames);

}  // namespace rigwire::bench
