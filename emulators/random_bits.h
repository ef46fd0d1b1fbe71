// The random numbers of a device: one small stream per purpose, from a seed given at construction,
// so that the same seed makes the same choices. Generator: splitmix64 (Steele, Lea, Flood,
// OOPSLA 2014); 2^64 long, passes BigCrush.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace rigwire::emulators {

class RandomBits {
 public:
  explicit RandomBits(std::uint64_t seed) : state_(seed) {}

  [[nodiscard]] std::uint64_t bits() {
    state_ += 0x9E37'79B9'7F4A'7C15U;
    std::uint64_t z = state_;
    z = (z ^ z >> 30U) * 0xBF58'476D'1CE4'E5B9U;
    z = (z ^ z >> 27U) * 0x94D0'49BB'1331'11EBU;
    return z ^ z >> 31U;
  }
  /// [0, 1), multiples of 2^-53.
  [[nodiscard]] double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  /// 0 .. count - 1. Precondition: count > 0.
  [[nodiscard]] std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>(((bits() >> 32U) * count) >> 32U);
  }
  /// Mean 0, standard deviation 1 (Box, Muller 1958).
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace rigwire::emulators
