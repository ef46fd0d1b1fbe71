// What the last hop of a CAN bus costs the processor, beside what the wire itself can carry.
//
// Frames of eight bytes with 29-bit identifiers go from the device's end to a reader in the same
// thread, as fast as both can. The wire's limit is a bus of 1 Mbit/s saturated with these frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rigwire::bench {

struct CanHopCost {
  std::string hop{};           ///< "slcan on a pty", "vcan0".
  std::uint64_t sent = 0;      ///< Frames that the device's end has sent.
  std::uint64_t received = 0;  ///< Frames that arrived at the reader.
  double device_ns = 0.0;      ///< CPU time of the device's end for one frame.
  double both_ns = 0.0;        ///< CPU time of both ends and the kernel between them.
  double per_second = 0.0;     ///< Frames that arrive, wall time.
  double wire_limit_per_second = 0.0;
  /// Share of a core for the device's end while the wire is saturated.
  [[nodiscard]] double share_of_core() const { return device_ns * 1e-9 * wire_limit_per_second; }
};

/// Measures slcan, and vcan0 where the host has it up. `frames` each, at least one. Throws
/// drivers::EndpointError when no pseudo-terminal can be opened.
[[nodiscard]] std::vector<CanHopCost> measure_can_hops(std::size_t frames = 50'000);

}  // namespace rigwire::bench
