// What one CAN frame costs the processor on its way through the emulated USB to CAN adapter and the
// USB/IP server, in memory, beside what a bus of 1 Mbit/s can carry.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rigwire::bench {

struct GsUsbCost {
  std::string way{};         ///< "to the host", "from the host and back as its echo".
  std::string frame{};       ///< "29-bit, 8 bytes".
  double nanoseconds = 0.0;  ///< CPU time of one frame, USB/IP messages of the host included;
                             ///< minimum of several runs.
  double per_second = 0.0;   ///< Frames that one core carries.
  double wire_limit_per_second = 0.0;  ///< Frames back to back on an otherwise idle bus.
  double core_share = 0.0;             ///< Share of one core while the bus is saturated, 0 .. 1.
  std::uint64_t wrong = 0;             ///< Frames that arrived changed.
};

/// Both ways, the common frame and the shortest; takes about a second.
[[nodiscard]] std::vector<GsUsbCost> measure_gs_usb();

}  // namespace rigwire::bench
