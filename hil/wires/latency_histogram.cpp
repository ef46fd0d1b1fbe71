#include "hil/wires/latency_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rigwire::hil {

std::size_t LatencyHistogram::class_of(std::uint64_t ns) {
  const auto bits = static_cast<unsigned>(std::bit_width(ns));
  if (bits <= kSubdivisionBits + 1) {
    return static_cast<std::size_t>(ns);  // exact below 64 ns
  }
  const unsigned shift = bits - kSubdivisionBits - 1;
  const std::size_t index =
      (std::size_t{shift} << kSubdivisionBits) + static_cast<std::size_t>(ns >> shift);
  return std::min(index, kClasses - 1);
}

std::uint64_t LatencyHistogram::upper_edge(std::size_t index) {
  const std::size_t linear = std::size_t{2} << kSubdivisionBits;
  if (index < linear) {
    return index;
  }
  const std::size_t shift = (index >> kSubdivisionBits) - 1;
  const std::uint64_t mantissa = index - (shift << kSubdivisionBits);
  return ((mantissa + 1) << shift) - 1;
}

void LatencyHistogram::record(Duration latency) {
  const Duration positive = std::max(latency, Duration{0});
  ++counts_[class_of(static_cast<std::uint64_t>(positive.count()))];
  ++count_;
  max_ = std::max(max_, positive);
  sum_ += positive;
}

std::uint64_t LatencyHistogram::up_to(Duration edge) const {
  if (edge < Duration{0}) {
    return 0;
  }
  const auto whole = static_cast<std::uint64_t>(edge.count());
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < kClasses && upper_edge(i) <= whole; ++i) {
    seen += counts_[i];
  }
  return edge >= max_ ? count_ : seen;
}

Duration LatencyHistogram::percentile(double share) const {
  if (count_ == 0) {
    return Duration{0};
  }
  const auto wanted =
      static_cast<std::uint64_t>(std::max(1.0, std::ceil(share * static_cast<double>(count_))));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < kClasses; ++i) {
    seen += counts_[i];
    if (seen >= wanted) {
      return std::min(max_, Duration{static_cast<std::int64_t>(upper_edge(i))});
    }
  }
  return max_;
}

LatencyClasses classes_of(const LatencyHistogram& latencies) {
  LatencyClasses classes{};
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < kLatencyEdges.size(); ++i) {
    const std::uint64_t up_to = latencies.up_to(kLatencyEdges[i]);
    classes[i] = up_to - below;
    below = up_to;
  }
  classes.back() = latencies.count() - below;
  return classes;
}

}  // namespace rigwire::hil
