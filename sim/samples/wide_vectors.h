// Loops over lanes that the compiler puts into the processor's vector registers.
#pragma once

#include <bit>
#include <cstdint>

// Marks functions that gain from registers of eight floats: compiled twice, and the processor's own
// version runs. Results are the same: no fused operations are used.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define RIGWIRE_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define RIGWIRE_WIDE_VECTORS
#endif

namespace rigwire {

/// which ? yes : no by masks. Written with `?`, the side that is not chosen may not be computed (it
/// could raise a floating-point exception), which leaves a branch in the loop.
[[nodiscard]] constexpr std::uint32_t choose(bool which, std::uint32_t yes, std::uint32_t no) {
  const std::uint32_t mask = 0U - static_cast<std::uint32_t>(which);
  return (yes & mask) | (no & ~mask);
}
[[nodiscard]] constexpr float choose(bool which, float yes, float no) {
  return std::bit_cast<float>(
      choose(which, std::bit_cast<std::uint32_t>(yes), std::bit_cast<std::uint32_t>(no)));
}
[[nodiscard]] constexpr double choose(bool which, double yes, double no) {
  const std::uint64_t mask = 0U - static_cast<std::uint64_t>(which);
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(yes) & mask) |
                               (std::bit_cast<std::uint64_t>(no) & ~mask));
}

/// x between 0 and 1; not a number: 0. Two plain `?` would be joined to one of three ways, which
/// costs three times as much in vectors.
[[nodiscard]] constexpr float clamp_to_one(float x) {
  const float above = choose(x > 0.0F, x, 0.0F);
  return above < 1.0F ? above : 1.0F;
}

}  // namespace rigwire
