// Hits of a packet of eight rays, side by side.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/lidar/ray_lanes.h"
#include "sim/scene/reflectance_grain.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

/// Index of each ray's hit into Scene::Internals::shading and instance_of; RTC_INVALID_GEOMETRY_ID:
/// no hit.
struct alignas(32) SurfaceNumbers : std::array<std::uint32_t, kLanes> {
  explicit SurfaceNumbers(const RTCHit8& hit) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      (*this)[i] = surface_number(hit.instID[0][i], hit.geomID[i]);
    }
  }
};

/// Without a hit, cosine, reflectance and gain are 0.
struct HitSurfaces {
  LaneArray normal_x;  ///< In the world; of any length, on either side.
  LaneArray normal_y;
  LaneArray normal_z;
  LaneArray cosine;  ///< Cosine of the angle of incidence, 0 .. 1.
  LaneArray reflectance;
  LaneArray retro_gain;
};

/// `shading` by SurfaceNumbers (Scene::Internals::shading). The rays' directions
/// have unit length.
void meet_surfaces(const Scene::Internals::Shading* shading, const RTCRayHit8& packet,
                   HitSurfaces& surfaces);

/// Replaces the reflectances of terrains with a cover by those of their soils there
/// (Scene::cover_terrain). Needed where a surface has a cover.
void cover_reflectance(const Scene::Internals& scene, const RTCRayHit8& packet,
                       const SurfaceNumbers& surface, LaneArray& reflectance);

/// Applies cover_reflectance() and then the grain at the hit points (reflectance_grain.h). Needed
/// where Scene::Internals::varies.
void vary_reflectance(const Scene::Internals& scene, const GrainLattice& lattice,
                      const RTCRayHit8& packet, LaneArray& reflectance);

/// Returns the reflectance, with cover and grain, of one place relative to the scene's local
/// origin.
[[nodiscard]] float varied_reflectance(const Scene::Internals& scene, const GrainLattice& lattice,
                                       std::uint32_t surface, const Eigen::Vector3f& p);

}  // namespace rigwire::sim
