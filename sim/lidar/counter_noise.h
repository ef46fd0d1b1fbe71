// Random numbers that depend on nothing but a key and a counter, so that the order in which threads
// draw them does not matter: the same shot has the same noise whoever casts it.
#pragma once

#include <cmath>
#include <cstdint>

namespace rigwire::sim {

/// 64 mixed bits of (key, counter): two rounds of the SplitMix64 finaliser.
[[nodiscard]] inline std::uint64_t counter_bits(std::uint64_t key, std::uint64_t counter) {
  std::uint64_t z = key ^ (counter * 0x9E3779B97F4A7C15ULL);
  for (int round = 0; round < 2; ++round) {
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    z ^= z >> 31U;
  }
  return z;
}

/// The value below which a standard normal variable stays with probability p, 0 < p < 1. Wichura,
/// "Algorithm AS 241: the percentage points of the normal distribution", Applied Statistics 37(3),
/// 1988, routine PPND7: relative error about 1e-7.
[[nodiscard]] inline double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * (((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179) /
           (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0);
  }
  double r = std::sqrt(-std::log(q < 0.0 ? p : 1.0 - p));
  double value = 0.0;
  if (r <= 5.0) {
    r -= 1.6;
    value = (((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777) /
            ((0.12021132975 * r + 0.73700164250) * r + 1.0);
  } else {
    r -= 5.0;
    value = (((0.017337203997 * r + 0.42868294337) * r + 3.0812263860) * r + 6.6579051150) /
            ((0.012258202635 * r + 0.24197894225) * r + 1.0);
  }
  return q < 0.0 ? -value : value;
}

/// Standard normal number of (key, counter).
[[nodiscard]] inline double counter_gaussian(std::uint64_t key, std::uint64_t counter) {
  // The middle of one of 2^52 equal parts of (0, 1): never 0, never 1.
  const double p = (static_cast<double>(counter_bits(key, counter) >> 12U) + 0.5) * 0x1.0p-52;
  return normal_quantile(p);
}

}  // namespace rigwire::sim
