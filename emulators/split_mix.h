// A stream of random numbers for faults: SplitMix64 (Steele, Lea, Flood, "Fast splittable
// pseudorandom number generators", OOPSLA 2014), the same on every machine. Emulators cannot reach
// sim/random.h; what devices measure is drawn there.
#pragma once

#include <cstdint>

namespace rigwire::emulators {

class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}

  /// 64 uniform bits.
  std::uint64_t bits() {
    state_ += 0x9E37'79B9'7F4A'7C15U;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58'476D'1CE4'E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D0'49BB'1331'11EBU;
    return mixed ^ (mixed >> 31U);
  }
  /// (0, 1].
  double uniform() { return (static_cast<double>(bits() >> 11U) + 1.0) * 0x1p-53; }
  /// 0 .. count - 1. Precondition: count > 0.
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>(((bits() >> 32U) * count) >> 32U);
  }

 private:
  std::uint64_t state_;
};

}  // namespace rigwire::emulators
