#include "sim/lidar/beam_lanes.h"

#include <algorithm>
#include <cmath>

#include "sim/lidar/link_budget.h"

namespace rigwire::sim {
namespace {

/// Maximum depth of a patch hit at grazing incidence.
constexpr float kDeepestPatch_m = 100.0F;

}  // namespace

RIGWIRE_WIDE_VECTORS void look_across(const RTCRay8& middle, const std::array<LaneArray, 3>& axis,
                                      Across& across) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float dx = middle.dir_x[i];
    const float dy = middle.dir_y[i];
    const float dz = middle.dir_z[i];
    // right = d x axis, unit; up = right x d.
    const float x = dy * axis[2][i] - dz * axis[1][i];
    const float y = dz * axis[0][i] - dx * axis[2][i];
    const float z = dx * axis[1][i] - dy * axis[0][i];
    const float scale = 1.0F / std::sqrt(x * x + y * y + z * z);
    const float rx = scale * x;
    const float ry = scale * y;
    const float rz = scale * z;
    across.right_x[i] = rx;
    across.right_y[i] = ry;
    across.right_z[i] = rz;
    across.up_x[i] = ry * dz - rz * dy;
    across.up_y[i] = rz * dx - rx * dz;
    across.up_z[i] = rx * dy - ry * dx;
  }
}

RIGWIRE_WIDE_VECTORS void aim_rays(const RTCRay8& middle, const Across& across,
                                   const SubRayAim& aim, std::size_t sub_ray, RayGroup& group) {
  float* const x = &group.x[sub_ray * kLanes];
  float* const y = &group.y[sub_ray * kLanes];
  float* const z = &group.z[sub_ray * kLanes];
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    x[i] = aim.shrink * (middle.dir_x[i] + aim.right * across.right_x[i] + aim.up * across.up_x[i]);
    y[i] = aim.shrink * (middle.dir_y[i] + aim.right * across.right_y[i] + aim.up * across.up_y[i]);
    z[i] = aim.shrink * (middle.dir_z[i] + aim.right * across.right_z[i] + aim.up * across.up_z[i]);
  }
}

RIGWIRE_WIDE_VECTORS void load_rays(const RTCRay8& middle, const RayGroup& group,
                                    const RayChoice& choice, RTCRayHit8& packet) {
  RTCRay8& ray = packet.ray;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto from = static_cast<std::size_t>(choice.ray[i]);
    const auto beam = static_cast<std::size_t>(choice.beam[i]);
    ray.dir_x[i] = group.x[from];
    ray.dir_y[i] = group.y[from];
    ray.dir_z[i] = group.z[from];
    ray.org_x[i] = middle.org_x[beam];
    ray.org_y[i] = middle.org_y[beam];
    ray.org_z[i] = middle.org_z[beam];
    ray.time[i] = middle.time[beam];
    ray.tnear[i] = middle.tnear[i];
    ray.tfar[i] = middle.tfar[i];
    ray.mask[i] = middle.mask[i];
    ray.id[i] = 0;
    ray.flags[i] = 0;
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
}

void store_hits(const RTCRayHit8& packet, const HitSurfaces& surfaces, const RayChoice& choice,
                RayGroup& group) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto to = static_cast<std::size_t>(choice.ray[i]);
    const bool met = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    group.range_m[to] = met ? packet.ray.tfar[i] : SubRayHits::kNothing;
    group.normal_x[to] = surfaces.normal_x[i];
    group.normal_y[to] = surfaces.normal_y[i];
    group.normal_z[to] = surfaces.normal_z[i];
    group.cosine[to] = surfaces.cosine[i];
    group.reflectance[to] = surfaces.reflectance[i];
    group.retro_gain[to] = surfaces.retro_gain[i];
  }
}

RIGWIRE_WIDE_VECTORS void receive_hits(const RayGroup& group, std::size_t sub_ray,
                                       const Across& across, const SubRayAim& aim,
                                       const Reception& reception, SubRayHits& hits) {
  const std::size_t first = sub_ray * kLanes;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::size_t ray = first + i;
    const float range = group.range_m[ray];
    const float cosine = group.cosine[ray];
    const float reflectance = reception.retro_alone ? 0.0F : group.reflectance[ray];
    // Energy weight x rho f(theta) / r^2; reported brightness without 1 / r^2.
    const float apparent = apparent_reflectance(reflectance, group.retro_gain[ray], cosine);
    const float reported = reception.compensates_incidence
                               ? apparent + reflectance * (1.0F - incidence_share(cosine))
                               : apparent;
    // Without a hit, `apparent` is 0.
    const bool returns = (range >= reception.minimum_m) & (apparent > 0.0F);
    hits.range_m[i] = range;
    hits.energy[i] = returns ? aim.weight * apparent / (range * range) : 0.0F;
    hits.brightness[i] = returns ? aim.weight * reported : 0.0F;

    const float nx = group.normal_x[ray];
    const float ny = group.normal_y[ray];
    const float nz = group.normal_z[ray];
    // Depth of the sub-ray's patch on its slanted plane: r (a |n . right| + b |n . up|) / |n . d|.
    const float to_right = nx * across.right_x[i] + ny * across.right_y[i] + nz * across.right_z[i];
    const float to_top = nx * across.up_x[i] + ny * across.up_y[i] + nz * across.up_z[i];
    const float along = nx * group.x[ray] + ny * group.y[ray] + nz * group.z[ray];
    const float slant = aim.patch_right * std::abs(to_right) + aim.patch_up * std::abs(to_top);
    const float patch = returns ? range * slant / std::max(std::abs(along), 1e-20F) : 0.0F;
    hits.patch_m[i] = std::min(patch, kDeepestPatch_m);
  }
}

RIGWIRE_WIDE_VECTORS void find_extent(std::span<const SubRayHits> hits, LaneArray& near_m,
                                      LaneArray& far_m) {
  near_m.fill(SubRayHits::kNothing);
  far_m.fill(0.0F);
  for (const SubRayHits& hit : hits) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const bool returns = hit.energy[i] > 0.0F;
      const float near = std::min(near_m[i], hit.range_m[i]);
      const float far = std::max(far_m[i], hit.range_m[i]);
      near_m[i] = returns ? near : near_m[i];
      far_m[i] = returns ? far : far_m[i];
    }
  }
}

RIGWIRE_WIDE_VECTORS void sum_up(std::span<const SubRayHits> hits, const LaneArray& near_m,
                                 EchoLanes& echo) {
  LaneArray behind;
  behind.fill(0.0F);
  echo.energy.fill(0.0F);
  echo.brightness.fill(0.0F);
  for (const SubRayHits& hit : hits) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const bool returns = hit.energy[i] > 0.0F;
      const float depth_m = returns ? hit.range_m[i] - near_m[i] : 0.0F;
      echo.energy[i] += hit.energy[i];
      echo.brightness[i] += hit.brightness[i];
      behind[i] += hit.energy[i] * depth_m;
    }
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Mean range weighted by energy.
    const bool any = echo.energy[i] > 0.0F;
    echo.range_m[i] = any ? near_m[i] + behind[i] / echo.energy[i] : 0.0F;
  }
}

}  // namespace rigwire::sim
