#include "sim/lidar/ray_lanes.h"

#include <algorithm>

#include "sim/lidar/counter_noise.h"

// Embree reads a packet in registers of eight floats. Written in halves, it waits for the stores;
// so where the processor has such registers, they are written whole. Results are the same: no fused
// operations are used.
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define RIGWIRE_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define RIGWIRE_WIDE_VECTORS
#endif

namespace rigwire::sim {

RIGWIRE_WIDE_VECTORS void fill_rays(const FiringLanes& firing, const LaserLanes& laser,
                                    const RayLimits& limits, RTCRayHit8& packet) {
  const auto f = [&](std::size_t column) { return firing.data() + column * kLanes; };
  const auto l = [&](std::size_t column) { return laser.data() + column * kLanes; };
  RTCRay8& ray = packet.ray;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float cosine = f(18)[i] * l(4)[i] - f(19)[i] * l(5)[i];
    const float sine = f(19)[i] * l(4)[i] + f(18)[i] * l(5)[i];
    const float x_S = l(0)[i] * cosine;
    const float y_S = -l(0)[i] * sine;
    const float z_S = l(1)[i];
    const float dt = l(3)[i];
    const float x = f(0)[i] * x_S + f(3)[i] * y_S + f(6)[i] * z_S;
    const float y = f(1)[i] * x_S + f(4)[i] * y_S + f(7)[i] * z_S;
    const float z = f(2)[i] * x_S + f(5)[i] * y_S + f(8)[i] * z_S;
    // The sensor has turned and moved on since the firing's first laser.
    ray.dir_x[i] = x + dt * (f(16)[i] * z - f(17)[i] * y);
    ray.dir_y[i] = y + dt * (f(17)[i] * x - f(15)[i] * z);
    ray.dir_z[i] = z + dt * (f(15)[i] * y - f(16)[i] * x);
    ray.org_x[i] = f(9)[i] + dt * f(12)[i] + l(2)[i] * f(6)[i];
    ray.org_y[i] = f(10)[i] + dt * f(13)[i] + l(2)[i] * f(7)[i];
    ray.org_z[i] = f(11)[i] + dt * f(14)[i] + l(2)[i] * f(8)[i];
    const float time = f(20)[i] + l(6)[i];
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

Lanes gaussian_lanes(std::uint64_t key, const std::array<std::uint64_t, kLanes>& shots) {
  Lanes q;
  Lanes nearer_end;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const double p = counter_uniform(key, shots[lane]);
    q(static_cast<Eigen::Index>(lane)) = static_cast<float>(p - 0.5);
    nearer_end(static_cast<Eigen::Index>(lane)) = static_cast<float>(std::min(p, 1.0 - p));
  }
  // Both parts for all lanes: the outer one is needed in three packets of four.
  const Lanes central = central_normal_quantile<float>(q);
  const Lanes outer = outer_normal_quantile<float>((-nearer_end.log()).sqrt().eval());
  return (q.abs() <= static_cast<float>(kCentralHalfWidth))
      .select(central, (q < 0.0F).select(-outer, outer));
}

}  // namespace rigwire::sim
