// Deterministic random streams, one per name.
//
// A stream is seeded by the run's seed and a name ("imu_boom/gyro"), so that adding a device or a
// thread never shifts another device's numbers. Generator: xoshiro256++ (Blackman and Vigna,
// "Scrambled linear pseudorandom number generators", ACM TOMS 47(4), 2021), seeded through
// SplitMix64; the name enters by FNV-1a. The distributions are our own because those of the
// standard library may differ between implementations: same seed, same numbers, on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace rigwire::sim {

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  /// 64 uniform bits.
  std::uint64_t bits();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [lower, upper).
  double uniform(double lower, double upper);
  /// Normal with mean 0 and standard deviation 1 (polar method of Marsaglia).
  double gaussian();

 private:
  std::array<std::uint64_t, 4> state_;
  double spare_gaussian_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace rigwire::sim
