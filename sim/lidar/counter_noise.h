// Random numbers that depend on nothing but a key and a counter, so that the order in which threads
// draw them does not matter: the same shot has the same noise whoever casts it.
#pragma once

#include <cmath>
#include <cstdint>

namespace rigwire::sim {

/// 64 mixed bits: the output of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom
/// number generators", OOPSLA 2014) started at `key`, after `counter` + 1 steps.
[[nodiscard]] inline std::uint64_t counter_bits(std::uint64_t key, std::uint64_t counter) {
  std::uint64_t z = key + (counter + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

/// Uniform in (0, 1) for (key, counter): the middle of one of 2^52 equal parts, never 0, never 1.
[[nodiscard]] inline double counter_uniform(std::uint64_t key, std::uint64_t counter) {
  return (static_cast<double>(counter_bits(key, counter) >> 12U) + 0.5) * 0x1.0p-52;
}

/// Half width of the middle part of the normal quantile, in probability.
inline constexpr double kCentralHalfWidth = 0.425;

/// The normal quantile at 0.5 + q for |q| <= kCentralHalfWidth; `Real` may be an array of `Scalar`.
template <class Scalar, class Real>
[[nodiscard]] Real central_normal_quantile(const Real& q) {
  const auto c = [](double value) { return static_cast<Scalar>(value); };
  const Real r = c(0.180625) - q * q;
  return q *
         (((c(59.109374720) * r + c(159.29113202)) * r + c(50.434271938)) * r + c(3.3871327179)) /
         (((c(67.187563600) * r + c(78.757757664)) * r + c(17.895169469)) * r + c(1.0));
}

/// The value below which a standard normal variable stays with probability p, 0 < p < 1. Wichura,
/// "Algorithm AS 241: the percentage points of the normal distribution", Applied Statistics 37(3),
/// 1988, routine PPND7: relative error about 1e-7.
[[nodiscard]] inline double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::abs(q) <= kCentralHalfWidth) {
    return central_normal_quantile<double>(q);
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

}  // namespace rigwire::sim
