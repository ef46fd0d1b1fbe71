#include "sim/lidar/clear_echo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "sim/lidar/hit_surface.h"
#include "sim/lidar/link_budget.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

using Shading = Scene::Internals::Shading;

constexpr std::size_t kMostShots = kMaxLasers * kLanes;

/// One number for each shot of a block, packet by packet, lane by lane. The loops over all of them
/// at once take half the time of loops over eight, whose steps wait for each other.
struct alignas(32) ShotArray : std::array<float, kMostShots> {};

/// Hits of the rays of a block.
struct Met {
  ShotArray range_m;
  ShotArray cosine;       ///< Cosine of incidence; 0 without a hit.
  ShotArray reflectance;  ///< Diffuse; 0 without a hit.
  ShotArray retro;        ///< A retro-reflector's share, as a multiple of a white surface.
  ShotArray variation;    ///< reflectance_grain.h
  ShotArray x, y, z;      ///< Where, in Embree's coordinates; only where the scene varies.
};

/// Rare, and so not worth its share of every packet.
void add_retro_reflectors(const Shading* shading, const SurfaceNumbers& surface, std::size_t first,
                          Met& met) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (surface[i] != RTC_INVALID_GEOMETRY_ID) {
      met.retro[first + i] =
          apparent_reflectance(0.0F, shading[surface[i]].retro_gain, met.cosine[first + i]);
    }
  }
}

/// Neighbouring rays mostly hit the same surface, so each surface is computed for all lanes, and
/// each lane keeps its own. `first` is the packet's first shot.
RIGWIRE_WIDE_VECTORS void meet(const Scene::Internals& scene, const RTCRayHit8& packet,
                               std::size_t first, Met& met) {
  const Shading* const shading = scene.shading.data();
  const RTCRay8& ray = packet.ray;
  const RTCHit8& hit = packet.hit;
  const SurfaceNumbers surface(hit);
  LaneArray along;
  LaneArray reflectance;
  LaneArray variation;
  along.fill(0.0F);
  reflectance.fill(0.0F);
  variation.fill(0.0F);
  float retro_gain = 0.0F;
  bool covered = false;
  unsigned done = RTC_INVALID_GEOMETRY_ID;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (surface[lane] == done || surface[lane] == RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    done = surface[lane];
    const Shading& its = shading[done];
    const Eigen::Matrix3f turn = its.R_WM;  // copies: what is behind a pointer may change
    const float* const R = turn.data();
    const float its_reflectance = its.reflectance;
    const float its_variation = its.variation;
    retro_gain += its.retro_gain;
    covered = covered || its.cover != nullptr;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float x = R[0] * hit.Ng_x[i] + R[3] * hit.Ng_y[i] + R[6] * hit.Ng_z[i];
      const float y = R[1] * hit.Ng_x[i] + R[4] * hit.Ng_y[i] + R[7] * hit.Ng_z[i];
      const float z = R[2] * hit.Ng_x[i] + R[5] * hit.Ng_y[i] + R[8] * hit.Ng_z[i];
      const float dot = x * ray.dir_x[i] + y * ray.dir_y[i] + z * ray.dir_z[i];
      const bool mine = surface[i] == done;
      along[i] = choose(mine, dot, along[i]);
      reflectance[i] = choose(mine, its_reflectance, reflectance[i]);
      variation[i] = choose(mine, its_variation, variation[i]);
    }
  }
  if (covered) {
    cover_reflectance(scene, packet, surface, reflectance);
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Rotations leave the normal's length as it is.
    const float square =
        hit.Ng_x[i] * hit.Ng_x[i] + hit.Ng_y[i] * hit.Ng_y[i] + hit.Ng_z[i] * hit.Ng_z[i];
    // cos(theta) = |n . d| / |n|.
    const bool any = (surface[i] != RTC_INVALID_GEOMETRY_ID) & (square > 0.0F);
    met.range_m[first + i] = ray.tfar[i];
    met.cosine[first + i] = any ? std::abs(along[i]) / std::sqrt(square) : 0.0F;
    met.reflectance[first + i] = reflectance[i];
    met.retro[first + i] = 0.0F;
  }
  if (scene.varies) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      met.variation[first + i] = variation[i];
      met.x[first + i] = ray.org_x[i] + ray.tfar[i] * ray.dir_x[i];
      met.y[first + i] = ray.org_y[i] + ray.tfar[i] * ray.dir_y[i];
      met.z[first + i] = ray.org_z[i] + ray.tfar[i] * ray.dir_z[i];
    }
  }
  if (retro_gain > 0.0F) {
    add_retro_reflectors(shading, surface, first, met);
  }
}

/// Varies the reflectances at the hit points.
RIGWIRE_WIDE_VECTORS void vary(const GrainLattice& lattice, std::size_t count, Met& met) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    met.reflectance[i] =
        grained(met.reflectance[i], met.variation[i], met.x[i], met.y[i], met.z[i], lattice);
  }
}

/// Limits and errors of the receiver.
struct Receiver {
  float minimum_m;
  float maximum_m;
  float echo_limit_m2;  ///< One over the minimum energy of an echo.
  float sigma_m;
  float reflectivity_sigma;
  float onset;
};

/// Errors of the shots, and in their places what is reported.
struct Report {
  ShotArray range_m;       ///< Before: the normal number of the range's noise.
  ShotArray reflectivity;  ///< Before: that of the reflectivity's.
};

RIGWIRE_WIDE_VECTORS void receive(const Met& met, const ClearEcho::LaserErrors& lasers,
                                  const Receiver& receiver, std::size_t count, Report& report) {
  const float* const bias_m = lasers.bias_m.data();
  const float* const gain = lasers.gain.data();
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    // Reflectance times f(theta), and what is sent straight back.
    const float brightness = met.reflectance[i] * incidence_share(met.cosine[i]) + met.retro[i];
    const float range = met.range_m[i];
    // Energy rho f(theta) / r^2 at or above the detection limit (link_budget.h).
    const float limit = receiver.echo_limit_m2 * brightness;
    const float square = range * range;
    // An echo that is too faint has infinite errors, and is not reported.
    const float own = receiver.onset * square / limit;
    const float growth = __builtin_sqrtf(1.0F + own * own);  // noise_growth()
    const float measured = range + (receiver.sigma_m * growth * report.range_m[i] + bias_m[i]);
    const float reported = brightness * gain[i] *
                           (1.0F + receiver.reflectivity_sigma * growth * report.reflectivity[i]);
    const bool seen = (limit >= square) & (range >= receiver.minimum_m) &
                      (measured >= receiver.minimum_m) & (measured <= receiver.maximum_m);
    report.range_m[i] = choose(seen, measured, 0.0F);
    report.reflectivity[i] = choose(seen, reported_reflectivity(reported), 0.0F);
  }
}

void tell_truth(const BlockCast& cast, const LaneMap& map, const Scene::Internals& scene,
                const RTCRayHit8& packet, const float* cosine) {
  const SurfaceNumbers surface(packet.hit);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t laser = map.laser[lane];
    LidarShotTruth& shot = cast.truth[cast.bank_of(map.firing[lane], laser)][laser % kBankLasers];
    if (surface[lane] != RTC_INVALID_GEOMETRY_ID) {
      shot = {packet.ray.tfar[lane], scene.instance_of[surface[lane]], cosine[lane]};
    }
  }
}

/// Returns of all shots to their firings.
void write(const BlockCast& cast, const Report& report) {
  std::array<std::array<LidarReturn*, kMaxBanks>, kLanes> returns;
  for (std::size_t place = 0; place < cast.block.count; ++place) {
    for (std::size_t bank = 0; bank < cast.banks; ++bank) {
      returns[place][bank] = cast.firings[cast.bank_of(place, bank * kBankLasers)].strongest.data();
    }
  }
  std::size_t shot = 0;
  for (const RingPacket& plan : cast.packets) {
    for (std::size_t lane = 0; lane < kLanes; ++lane, ++shot) {
      const std::uint32_t laser = plan.map.laser[lane];
      returns[plan.map.firing[lane]][laser / kBankLasers][laser % kBankLasers] = {
          report.range_m[shot], report.reflectivity[shot]};
    }
  }
}

/// Random numbers of all shots of the block.
void draw(const BlockCast& cast, std::uint64_t key, std::size_t count, Report& report) {
  std::array<std::uint64_t, kMostShots> shots;
  std::array<std::uint64_t, kLanes> firings;  // number of the first laser's shot
  for (std::size_t place = 0; place < cast.block.count; ++place) {
    firings[place] = cast.shot_number(place, 0);
  }
  std::uint64_t* shot = shots.data();
  for (const RingPacket& plan : cast.packets) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      *shot++ = firings[plan.map.firing[lane]] + plan.map.laser[lane];
    }
  }
  gaussian(key, std::span(shots).first(count), std::span(report.range_m).first(count),
           std::span(report.reflectivity).first(count));
}

}  // namespace

ClearEcho::ClearEcho(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                     const EchoModel& receiver, const HeadLanes& head, std::uint64_t noise_key)
    : minimum_m_(static_cast<float>(pattern.minimum_range_m)),
      maximum_m_(static_cast<float>(pattern.maximum_range_m)),
      sigma_m_(static_cast<float>(parameters.range_sigma_m)),
      reflectivity_sigma_(static_cast<float>(parameters.reflectivity_sigma)),
      onset_(receiver.noise_onset()),
      echo_limit_m2_(1.0F / receiver.threshold()),
      noise_key_(noise_key) {
  for (std::size_t firings = 1; firings <= kLanes; ++firings) {
    LaserErrors& errors = errors_[firings - 1];
    for (const RingPacket& plan : head.packets(firings)) {
      for (const std::uint32_t laser : plan.map.laser) {
        errors.bias_m.push_back(receiver.bias_m(laser));
        errors.gain.push_back(receiver.reflectivity_gain(laser));
      }
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

  Met met;
  RTCRayHit8 packet{};
  std::size_t count = 0;  // of shots so far
  for (const RingPacket& plan : cast.packets) {
    fill_packet(cast.block, plan, cast.limits, packet);
    in.intersect(valid.data(), context, packet);
    meet(in, packet, count, met);
    if (!cast.truth.empty()) {
      tell_truth(cast, plan.map, in, packet, &met.cosine[count]);
    }
    count += kLanes;
  }
  if (in.varies) {
    vary(GrainLattice(in.origin_W), count, met);
  }
  Report report;
  if (sigma_m_ > 0.0F || reflectivity_sigma_ > 0.0F) {
    draw(cast, noise_key_, count, report);
  } else {
    std::fill_n(report.range_m.begin(), count, 0.0F);
    std::fill_n(report.reflectivity.begin(), count, 0.0F);
  }
  receive(met, errors_[cast.block.count - 1],
          {minimum_m_, maximum_m_, echo_limit_m2_, sigma_m_, reflectivity_sigma_, onset_}, count,
          report);
  write(cast, report);
}

}  // namespace rigwire::sim
