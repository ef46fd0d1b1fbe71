#include "sim/lidar/clear_echo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sim/lidar/hit_surface.h"
#include "sim/lidar/link_budget.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

using Shading = Scene::Internals::Shading;

/// How the rays of a packet meet the surfaces that they hit; zero where nothing was hit.
struct Incidence {
  LaneArray cosine;
  LaneArray brightness;  ///< As a multiple of a white surface met head on.
};

/// Rare, and so not worth its share of every packet.
void add_retro_reflectors(const Shading* shading, const SurfaceNumbers& numbers,
                          Incidence& incidence) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (numbers[i] != RTC_INVALID_GEOMETRY_ID) {
      const Shading& surface = shading[numbers[i]];
      incidence.brightness[i] =
          apparent_reflectance(surface.reflectance, surface.retro_gain, incidence.cosine[i]);
    }
  }
}

/// Neighbours mostly meet the same surface; so one surface after the other is worked out for all
/// lanes, and each lane keeps its own.
RIGWIRE_WIDE_VECTORS void meet(const Shading* shading, const RTCRayHit8& packet,
                               Incidence& incidence) {
  const RTCRay8& ray = packet.ray;
  const RTCHit8& hit = packet.hit;
  const SurfaceNumbers surface(hit);
  LaneArray along;
  LaneArray reflectance;
  along.fill(0.0F);
  reflectance.fill(0.0F);
  float retro_gain = 0.0F;
  unsigned done = RTC_INVALID_GEOMETRY_ID;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (surface[lane] == done || surface[lane] == RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    done = surface[lane];
    const float* const R = shading[done].R_WM.data();
    const float its_reflectance = shading[done].reflectance;
    retro_gain += shading[done].retro_gain;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float x = R[0] * hit.Ng_x[i] + R[3] * hit.Ng_y[i] + R[6] * hit.Ng_z[i];
      const float y = R[1] * hit.Ng_x[i] + R[4] * hit.Ng_y[i] + R[7] * hit.Ng_z[i];
      const float z = R[2] * hit.Ng_x[i] + R[5] * hit.Ng_y[i] + R[8] * hit.Ng_z[i];
      const float dot = x * ray.dir_x[i] + y * ray.dir_y[i] + z * ray.dir_z[i];
      along[i] = surface[i] == done ? dot : along[i];
      reflectance[i] = surface[i] == done ? its_reflectance : reflectance[i];
    }
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Rotations leave the normal's length as it is.
    const float square =
        hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
    // Reflectance times f(theta), cos(theta) = |n . d| / |n|.
    const bool met = (surface[i] != RTC_INVALID_GEOMETRY_ID) & (square > 0.0F);
    incidence.cosine[i] = met ? std::abs(along[i]) / std::sqrt(square) : 0.0F;
    incidence.brightness[i] = reflectance[i] * incidence_share(incidence.cosine[i]);
  }
  if (retro_gain > 0.0F) {
    add_retro_reflectors(shading, surface, incidence);
  }
}

/// What the receiver reports.
struct Window {
  float minimum_m;
  float maximum_m;
  float echo_limit_m2;  ///< One over the least energy of an echo.
};

RIGWIRE_WIDE_VECTORS void receive(const RTCRay8& ray, const Incidence& incidence,
                                  const float* errors_m, const Window& window,
                                  std::array<LidarReturn, kLanes>& echoes) {
  LaneArray range_m;
  LaneArray reflectivity;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float brightness = incidence.brightness[i];
    const float range = ray.tfar[i];
    const float measured = range + errors_m[i];
    // Energy rho f(theta) / r^2 at or above the least that is detected (link_budget.h).
    const bool seen = (window.echo_limit_m2 * brightness >= range * range) &
                      (range >= window.minimum_m) & (measured >= window.minimum_m) &
                      (measured <= window.maximum_m);
    range_m[i] = seen ? measured : 0.0F;
    reflectivity[i] = seen ? reported_reflectivity(brightness) : 0.0F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    echoes[i] = {range_m[i], reflectivity[i]};
  }
}

void tell_truth(const BlockCast& cast, const LaneMap& map, const Scene::Internals& scene,
                const RTCRayHit8& packet, const LaneArray& cosine) {
  const SurfaceNumbers surface(packet.hit);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t laser = map.laser[lane];
    LidarShotTruth& shot = cast.truth[cast.bank_of(map.firing[lane], laser)][laser % kBankLasers];
    if (surface[lane] != RTC_INVALID_GEOMETRY_ID) {
      shot = {packet.ray.tfar[lane], scene.instance_of[surface[lane]], cosine[lane]};
    }
  }
}

}  // namespace

ClearEcho::ClearEcho(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                     const EchoModel& receiver, std::uint64_t noise_key)
    : minimum_m_(static_cast<float>(pattern.minimum_range_m)),
      maximum_m_(static_cast<float>(pattern.maximum_range_m)),
      sigma_m_(static_cast<float>(parameters.range_sigma_m)),
      echo_limit_m2_(1.0F / receiver.threshold()),
      noise_key_(noise_key) {
  for (std::size_t laser = 0; laser < kMaxLasers; ++laser) {
    biases_m_[laser] = receiver.bias_m(laser);
  }
}

void ClearEcho::draw_errors(const BlockCast& cast, std::span<float> errors_m) const {
  const auto drawn = errors_m.first(cast.packets.size() * kLanes);
  std::ranges::fill(drawn, 0.0F);
  if (sigma_m_ > 0.0F) {
    std::array<std::uint64_t, kMaxLasers * kLanes> shots;
    std::uint64_t* shot = shots.data();
    for (const RingPacket& plan : cast.packets) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        *shot++ = cast.shot_number(plan.map.firing[lane], plan.map.laser[lane]);
      }
    }
    gaussian(noise_key_, std::span(shots).first(drawn.size()), drawn);
  }
  float* error_m = drawn.data();
  for (const RingPacket& plan : cast.packets) {
    for (std::size_t lane = 0; lane < kLanes; ++lane, ++error_m) {
      *error_m = sigma_m_ * *error_m + biases_m_[plan.map.laser[lane]];
    }
  }
}

void ClearEcho::cast(const BlockCast& cast) const {
  const FlushDenormals flush;
  const Scene::Internals& in = cast.scene.internals();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, kLanes> valid;
  valid.fill(-1);

  const Window window{minimum_m_, maximum_m_, echo_limit_m2_};
  alignas(32) std::array<float, kMaxLasers * kLanes> errors_m;
  draw_errors(cast, errors_m);
  RTCRayHit8 packet{};
  Incidence incidence;
  std::array<LidarReturn, kLanes> echoes;
  const float* packet_errors_m = errors_m.data();
  for (const RingPacket& plan : cast.packets) {
    fill_packet(cast.block, plan, cast.limits, packet);
    in.intersect(valid.data(), context, packet);
    meet(in.shading.data(), packet, incidence);
    receive(packet.ray, incidence, packet_errors_m, window, echoes);
    packet_errors_m += kLanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::uint32_t laser = plan.map.laser[lane];
      const std::size_t bank = cast.bank_of(plan.map.firing[lane], laser);
      cast.firings[bank].strongest[laser % kBankLasers] = echoes[lane];
    }
    if (!cast.truth.empty()) {
      tell_truth(cast, plan.map, in, packet, incidence.cosine);
    }
  }
}

}  // namespace rigwire::sim
