// What a short piece of work costs the processor.
#pragma once

#include <algorithm>
#include <limits>

#include "hil/executive/cpu_time.h"

namespace rigwire::bench {

inline constexpr int kCostVariants =
    512;  ///< Different inputs, so that nothing is found once only.

/// Prevents the compiler from removing the computation of `*data`.
inline void keep(const void* data) {
  asm volatile("" : : "g"(data) : "memory");
}

/// Returns nanoseconds of CPU time of one call of make(i), i = 0 .. kCostVariants - 1 over and
/// over: the minimum of five runs of 40 ms.
template <class Make>
[[nodiscard]] double nanoseconds_of(const Make& make) {
  constexpr int kRuns = 5;
  constexpr double kRun_s = 0.04;
  double least_ns = std::numeric_limits<double>::max();
  for (int run = 0; run < kRuns; ++run) {
    long calls = 0;
    const double begin_s = hil::thread_cpu_seconds();
    double spent_s = 0.0;
    while (spent_s < kRun_s) {
      for (int i = 0; i < kCostVariants; ++i) {
        make(i);
      }
      calls += kCostVariants;
      spent_s = hil::thread_cpu_seconds() - begin_s;
    }
    least_ns = std::min(least_ns, 1e9 * spent_s / static_cast<double>(calls));
  }
  return least_ns;
}

}  // namespace rigwire::bench
