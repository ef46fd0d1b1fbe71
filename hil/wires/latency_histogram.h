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
  /// Returns the minimum upper class edge below which `share` (0..1) of the records lie, at most
  /// max(); zero when empty.
  [[nodiscard]] Duration percentile(double share) const;
  [[nodiscard]] Duration max() const { return max_; }
  [[nodiscard]] Duration sum() const { return sum_; }
  /// Returns how many are at most `edge`, to the width of a class.
  [[nodiscard]] std::uint64_t up_to(Duration edge) const;

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
  Duration sum_{0};
};

/// Edges of the classes of a distribution in reports and metrics.
inline constexpr std::array<Duration, 14> kLatencyEdges{
    std::chrono::microseconds{10},  std::chrono::microseconds{20},  std::chrono::microseconds{50},
    std::chrono::microseconds{100}, std::chrono::microseconds{200}, std::chrono::microseconds{500},
    std::chrono::milliseconds{1},   std::chrono::milliseconds{2},   std::chrono::milliseconds{5},
    std::chrono::milliseconds{10},  std::chrono::milliseconds{20},  std::chrono::milliseconds{50},
    std::chrono::milliseconds{100}, std::chrono::seconds{1}};

/// Counts between each of these edges and the one before, and above the last.
using LatencyClasses = std::array<std::uint64_t, kLatencyEdges.size() + 1>;
[[nodiscard]] LatencyClasses classes_of(const LatencyHistogram& latencies);

}  // namespace rigwire::hil
