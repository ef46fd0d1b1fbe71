// What one outlet still has to put on its wire: a bounded queue of units of output with their due
// times.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hil/wires/wire_statistics.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// First in, first out; all memory is taken at construction. A unit that does not fit is refused
/// and counted as dropped in the statistics it belongs to.
class EmissionQueue {
 public:
  struct Unit {
    SimTime due{};
    std::uint64_t tag = 0;  ///< Meaning is the outlet's: a connection, for example.
    WireStatistics* statistics = nullptr;
    std::span<const std::uint8_t> bytes;
  };

  /// Room for `units` units of together `bytes` bytes.
  EmissionQueue(std::size_t units, std::size_t bytes);

  /// False when it did not fit. `statistics` must live until the unit is popped; the bytes are
  /// copied. Precondition: `due` is not earlier than that of the unit before.
  bool push(SimTime due, std::uint64_t tag, WireStatistics& statistics,
            std::span<const std::uint8_t> bytes);

  [[nodiscard]] bool empty() const { return count_ == 0; }
  /// kNever when empty.
  [[nodiscard]] SimTime next_due() const;
  /// Precondition: not empty. Valid until pop().
  [[nodiscard]] Unit front() const;
  void pop();

 private:
  struct Slot {
    SimTime due{};
    std::uint64_t tag = 0;
    WireStatistics* statistics = nullptr;
    std::size_t offset = 0;
    std::size_t length = 0;
  };

  std::vector<Slot> slots_;
  std::vector<std::uint8_t> storage_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t write_at_ = 0;  ///< Where the next unit's bytes go, if they fit before the end.
};

}  // namespace rigwire::hil
