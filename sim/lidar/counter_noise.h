// Random numbers that depend only on a key and a counter, so that the order in which threads draw
// them does not matter: the same shot has the same noise on any thread.
#pragma once

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

// The normal quantile, the value below which a standard normal variable stays with probability p,
// in two parts: Wichura, "Algorithm AS 241: the percentage points of the normal distribution",
// Applied Statistics 37(3), 1988, routine PPND7; relative error about 1e-7 in double, 1e-6 in
// float.

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

/// The size of the normal quantile at distance p = exp(-r^2) from the nearer end of (0, 1), for
/// r <= 5, and to 3 % up to r = 6.1, the farthest that counter_uniform() comes.
template <class Scalar, class Real>
[[nodiscard]] Real outer_normal_quantile(const Real& root) {
  const auto c = [](double value) { return static_cast<Scalar>(value); };
  const Real r = root - c(1.6);
  return (((c(0.17023821103) * r + c(1.3067284816)) * r + c(2.7568153900)) * r + c(1.4234372777)) /
         ((c(0.12021132975) * r + c(0.73700164250)) * r + c(1.0));
}

}  // namespace rigwire::sim
