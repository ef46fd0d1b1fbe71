// Counts of latencies in log-linear classes: constant memory, no allocation, percentiles to 3 %.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/samples/time.h"

namespace rigwire::hil {

/// Each power of two of nanoseconds is divided in 32 classes, up to 2^40 ns (18 minutes).
class LatencyHistogram {
 public:
  /// Negative spans count as zero, longer ones than the range in the last class; max() stays exact.
  void record(Duration latency);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// The least upper class edge below which `share` (0..1) of the records lie, never above max();
  /// zero when empty.
  [[nodiscard]] Duration percentile(double share) const;
  [[nodiscard]] Duration max() const { return max_; }

 private:
  static constexpr unsigned kSubdivisionBits = 5;
  static constexpr unsigned kMaximumBits = 40;
  static constexpr std::size_t kClasses = std::size_t{kMaximumBits - kSubdivisionBits + 1}
                                          << kSubdivisionBits;

  [[nodiscard]] static std::size_t class_of(std::uint64_t ns);
  [[nodiscard]] static std::uint64_t upper_edge(std::size_t index);

  std::array<std::uint64_t, kClasses> counts_{};
  std::uint64_t count_ = 0;
  Duration max_{0};
};

}  // namespace rigwire::hil
