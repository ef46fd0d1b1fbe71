// What one message of each wire costs the processor, beside what the wire itself can carry.
#pragma once

#include <string>
#include <vector>

namespace rigwire::bench {

struct MessageCost {
  std::string message{};
  std::string wire{};
  std::size_t bytes = 0;               ///< Size of the message; of the answer, for a round trip.
  double nanoseconds = 0.0;            ///< CPU time of one, minimum of several runs.
  double per_second = 0.0;             ///< Messages that one core makes.
  double wire_limit_per_second = 0.0;  ///< Messages back to back on an otherwise idle wire.
  double worst_error = 0.0;            ///< Error of a value after encoding and decoding,
  std::string error_unit{};            ///< in this unit.
  double half_count = 0.0;             ///< Half of the format's resolution, same unit.
};

/// All messages; takes a few seconds.
[[nodiscard]] std::vector<MessageCost> measure_messages();

}  // namespace rigwire::bench
