#include "sim/lidar/ray_lanes.h"

#include <algorithm>
#include <bit>
#include <numbers>

#include "sim/lidar/counter_noise.h"

namespace rigwire::sim {

RIGWIRE_WIDE_VECTORS void fill_rays(const FiringLanes& firing, const LaserLanes& laser,
                                    const RayLimits& limits, RTCRayHit8& packet) {
  const auto f = [&](std::size_t column) { return firing.data() + column * kLanes; };
  const auto l = [&](std::size_t column) { return laser.data() + column * kLanes; };
  RTCRay8& ray = packet.ray;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Rotor's turn by the laser's delay, as series: the angle is small.
    const float dt = l(6)[i];
    const float turn = dt * f(20)[i];
    const float cos_turn = 1.0F - 0.5F * turn * turn;
    const float sin_turn = turn - turn * turn * turn * (1.0F / 6.0F);
    const float cos_rotor = f(18)[i] * cos_turn - f(19)[i] * sin_turn;
    const float sin_rotor = f(19)[i] * cos_turn + f(18)[i] * sin_turn;
    // Azimuth = rotor + laser's offset, clockwise from x; then the beam turned into the world.
    const float cosine = cos_rotor * l(2)[i] - sin_rotor * l(3)[i];
    const float sine = sin_rotor * l(2)[i] + cos_rotor * l(3)[i];
    const float x_S = l(0)[i] * cosine;
    const float y_S = -l(0)[i] * sine;
    const float z_S = l(1)[i];
    const float x = f(0)[i] * x_S + f(3)[i] * y_S + f(6)[i] * z_S;
    const float y = f(1)[i] * x_S + f(4)[i] * y_S + f(7)[i] * z_S;
    const float z = f(2)[i] * x_S + f(5)[i] * y_S + f(8)[i] * z_S;
    // The sensor has turned and moved on since the firing's first laser.
    ray.dir_x[i] = x + dt * (f(16)[i] * z - f(17)[i] * y);
    ray.dir_y[i] = y + dt * (f(17)[i] * x - f(15)[i] * z);
    ray.dir_z[i] = z + dt * (f(15)[i] * y - f(16)[i] * x);
    // Start: the sensor's place at the laser's instant, and the laser beside and above its origin.
    const float px_S = -l(5)[i] * sine;
    const float py_S = -l(5)[i] * cosine;
    const float pz_S = l(4)[i];
    ray.org_x[i] = f(9)[i] + dt * f(12)[i] + f(0)[i] * px_S + f(3)[i] * py_S + f(6)[i] * pz_S;
    ray.org_y[i] = f(10)[i] + dt * f(13)[i] + f(1)[i] * px_S + f(4)[i] * py_S + f(7)[i] * pz_S;
    ray.org_z[i] = f(11)[i] + dt * f(14)[i] + f(2)[i] * px_S + f(5)[i] * py_S + f(8)[i] * pz_S;
    const float time = f(21)[i] + dt * limits.slices_per_s;
    ray.time[i] = time < 1.0F ? time : 1.0F;
    ray.tnear[i] = limits.near_m;
    ray.tfar[i] = limits.far_m;
    ray.mask[i] = limits.mask;
    ray.id[i] = 0;
    ray.flags[i] = 0;
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
}

namespace {

/// Natural logarithm of a positive normal number, relative error below 1e-6: ln(2^e m) with m
/// within sqrt(2) of 1, by the series of the inverse hyperbolic tangent, whose first term left out
/// is below 1e-9.
inline float natural_logarithm(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  constexpr std::int32_t kRootHalf = 0x3F3504F3;
  const std::int32_t exponent = (bits - kRootHalf) >> 23;
  const float m = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float s = (m - 1.0F) / (m + 1.0F);
  const float s2 = s * s;
  return static_cast<float>(exponent) * std::numbers::ln2_v<float> +
         2.0F * s *
             (1.0F + s2 * (1.0F / 3.0F + s2 * (0.2F + s2 * (1.0F / 7.0F + s2 * (1.0F / 9.0F)))));
}

}  // namespace

RIGWIRE_WIDE_VECTORS void gaussian(std::uint64_t key, std::span<const std::uint64_t> shots,
                                   std::span<float> normal, std::span<float> speckle) {
  // In blocks: the whole of one step before the next, because a number's steps wait for each other.
  constexpr std::size_t kBlock = 64;
  alignas(32) std::array<std::int32_t, kBlock> drawn;
  alignas(32) std::array<std::uint32_t, kBlock> others;
  for (std::size_t begin = 0; begin < shots.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, shots.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t bits = counter_bits(key, shots[begin + i]);
      drawn[i] = static_cast<std::int32_t>(bits >> 32U);
      others[i] = static_cast<std::uint32_t>(bits);
    }
    float* const target = normal.data() + begin;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
      // The middle of one of 2^32 equal parts of (0, 1), as distance from the middle, and from the
      // nearer end.
      const std::int32_t from_end = (drawn[i] ^ (drawn[i] >> 31)) ^ 0x7FFFFFFF;
      const float nearer_end = (static_cast<float>(from_end) + 0.5F) * 0x1.0p-32F;
      const float q = (static_cast<float>(drawn[i]) + 0.5F) * 0x1.0p-32F;
      const float central = central_normal_quantile<float>(q);
      const float size =
          outer_normal_quantile<float>(__builtin_sqrtf(-natural_logarithm(nearer_end)));
      const float outer = q < 0.0F ? -size : size;
      const bool middle = nearer_end >= 0.5F - static_cast<float>(kCentralHalfWidth);
      target[i] = middle ? central : outer;
    }
    if (speckle.empty()) {
      continue;
    }
    float* const sum = speckle.data() + begin;
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) {
      // Four bytes, each of 0 .. 255: mean 510, variance 4 (256^2 - 1) / 12 = 147.8^2.
      const std::uint32_t pairs = (others[i] & 0x00FF00FFU) + ((others[i] >> 8U) & 0x00FF00FFU);
      const auto bytes = static_cast<std::int32_t>((pairs & 0xFFFFU) + (pairs >> 16U));
      sum[i] = static_cast<float>(bytes - 510) * static_cast<float>(1.0 / 147.80054);
    }
  }
}

}  // namespace rigwire::sim
