#include "sim/lidar/clear_echo.h"

#include <array>
#include <cmath>
#include <vector>

#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// Reflectance of the target that the maximum range is stated for.
constexpr float kReferenceReflectance = 0.9F;

using Shading = Scene::Internals::Shading;

/// How the rays of a packet meet the surfaces that they hit; zero where nothing was hit.
struct Incidence {
  LaneArray cosine;
  LaneArray reflectance;
};

/// Neighbours mostly meet the same instance; so one instance after the other is worked out for all
/// lanes, and each lane keeps its own.
RIGWIRE_WIDE_VECTORS void meet(const Shading* shading, const RTCRayHit8& packet,
                               Incidence& incidence) {
  const RTCRay8& ray = packet.ray;
  const RTCHit8& hit = packet.hit;
  const unsigned* const instance = hit.instID[0];
  alignas(32) LaneArray along;
  along.fill(0.0F);
  incidence.reflectance.fill(0.0F);
  unsigned done = RTC_INVALID_GEOMETRY_ID;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (instance[lane] == done || instance[lane] == RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    done = instance[lane];
    const float* const R = shading[done].R_WM.data();
    const float reflectance = shading[done].reflectance;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float x = R[0] * hit.Ng_x[i] + R[3] * hit.Ng_y[i] + R[6] * hit.Ng_z[i];
      const float y = R[1] * hit.Ng_x[i] + R[4] * hit.Ng_y[i] + R[7] * hit.Ng_z[i];
      const float z = R[2] * hit.Ng_x[i] + R[5] * hit.Ng_y[i] + R[8] * hit.Ng_z[i];
      const float dot = x * ray.dir_x[i] + y * ray.dir_y[i] + z * ray.dir_z[i];
      along[i] = instance[i] == done ? dot : along[i];
      incidence.reflectance[i] = instance[i] == done ? reflectance : incidence.reflectance[i];
    }
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Rotations leave the normal's length as it is.
    const float square =
        hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
    const bool met = instance[i] != RTC_INVALID_GEOMETRY_ID && square > 0.0F;
    incidence.cosine[i] = met ? __builtin_fabsf(along[i]) / __builtin_sqrtf(square) : 0.0F;
  }
}

/// What the receiver reports.
struct Window {
  float minimum_m;
  float maximum_m;
  float echo_limit_m2;
};

RIGWIRE_WIDE_VECTORS void receive(const RTCRay8& ray, const Incidence& incidence,
                                  const LaneArray& noise_m, const Window& window,
                                  std::array<LidarReturn, kLanes>& echoes) {
  LaneArray range_m;
  LaneArray reflectivity;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float apparent = incidence.reflectance[i] * incidence.cosine[i];
    const float range = ray.tfar[i];
    const float measured = range + noise_m[i];
    const bool seen = (window.echo_limit_m2 * apparent >= range * range) &
                      (range >= window.minimum_m) & (measured >= window.minimum_m) &
                      (measured <= window.maximum_m);
    range_m[i] = seen ? measured : 0.0F;
    reflectivity[i] = seen ? apparent : 0.0F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    echoes[i] = {range_m[i], reflectivity[i]};
  }
}

}  // namespace

ClearEcho::ClearEcho(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                     std::uint64_t noise_key)
    : minimum_m_(static_cast<float>(pattern.minimum_range_m)),
      maximum_m_(static_cast<float>(pattern.maximum_range_m)),
      sigma_m_(static_cast<float>(parameters.range_sigma_m)),
      echo_limit_m2_(maximum_m_ * maximum_m_ / kReferenceReflectance),
      noise_key_(noise_key) {}

void ClearEcho::cast(const BlockCast& cast) const {
  const FlushDenormals flush;
  const Scene::Internals& in = cast.scene.internals();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kLanes> valid;
  valid.fill(-1);

  const Window window{minimum_m_, maximum_m_, echo_limit_m2_};
  RTCRayHit8 packet{};
  Incidence incidence;
  LaneArray noise_m;
  noise_m.fill(0.0F);
  for (const RingPacket& plan : cast.packets) {
    fill_packet(cast.block, plan, cast.limits, packet);
    rtcIntersect8(valid.data(), in.top.get(), &context, &packet);
    meet(in.shading.data(), packet, incidence);
    if (sigma_m_ > 0.0F) {
      std::array<std::uint64_t, kLanes> shots;
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        shots[lane] = cast.shot_number(plan.map.firing[lane], plan.map.laser[lane]);
      }
      gaussian_lanes(noise_key_, shots, noise_m);
      for (float& noise : noise_m) {
        noise *= sigma_m_;
      }
    }
    std::array<LidarReturn, kLanes> echoes;
    receive(packet.ray, incidence, noise_m, window, echoes);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::uint32_t laser = plan.map.laser[lane];
      const std::size_t bank = cast.bank_of(plan.map.firing[lane], laser);
      cast.firings[bank].strongest[laser % kBankLasers] = echoes[lane];
      if (!cast.truth.empty()) {
        const unsigned instance = packet.hit.instID[0][lane];
        cast.truth[bank][laser % kBankLasers] =
            instance == RTC_INVALID_GEOMETRY_ID
                ? LidarShotTruth{}
                : LidarShotTruth{packet.ray.tfar[lane], in.instance_of[instance],
                                 incidence.cosine[lane]};
      }
    }
  }
}

}  // namespace rigwire::sim
