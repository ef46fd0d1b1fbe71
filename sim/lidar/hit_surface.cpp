#include "sim/lidar/hit_surface.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

using Shading = Scene::Internals::Shading;

/// Mean reflectance of a surface there.
float mean_reflectance(const Shading& surface, const Eigen::Vector3d& origin_W, float x, float y) {
  const Scene::Internals::Cover& cover = *surface.cover;
  const double per_cell = 1.0 / cover.cell_m;
  const double column = (origin_W.x() + static_cast<double>(x) - cover.origin_m.x()) * per_cell;
  const double row = (origin_W.y() + static_cast<double>(y) - cover.origin_m.y()) * per_cell;
  // A hit on the very edge may lie a rounding beyond it.
  const auto within = [](double place, int count) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(place), 0, count - 1));
  };
  const float own = cover.reflectances[cover.cells[within(row, cover.rows) *
                                                       static_cast<std::size_t>(cover.columns) +
                                                   within(column, cover.columns)]];
  return own > 0.0F ? own : surface.reflectance;
}

RIGWIRE_WIDE_VECTORS void grain_lanes(const RTCRay8& ray, const GrainLattice& lattice,
                                      const LaneArray& variation, LaneArray& reflectance) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    reflectance[i] =
        grained(reflectance[i], variation[i], ray.org_x[i] + ray.tfar[i] * ray.dir_x[i],
                ray.org_y[i] + ray.tfar[i] * ray.dir_y[i],
                ray.org_z[i] + ray.tfar[i] * ray.dir_z[i], lattice);
  }
}

}  // namespace

// Neighbouring rays mostly hit the same instance: each instance is computed for all lanes, and each
// lane keeps its own.
RIGWIRE_WIDE_VECTORS void meet_surfaces(const Scene::Internals::Shading* shading,
                                        const RTCRayHit8& packet, HitSurfaces& surfaces) {
  const RTCRay8& ray = packet.ray;
  const RTCHit8& hit = packet.hit;
  const SurfaceNumbers instance(hit);
  surfaces.normal_x.fill(0.0F);
  surfaces.normal_y.fill(0.0F);
  surfaces.normal_z.fill(0.0F);
  surfaces.reflectance.fill(0.0F);
  surfaces.retro_gain.fill(0.0F);
  unsigned done = RTC_INVALID_GEOMETRY_ID;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (instance[lane] == done || instance[lane] == RTC_INVALID_GEOMETRY_ID) {
      continue;
    }
    done = instance[lane];
    const float* const R = shading[done].R_WM.data();
    const float reflectance = shading[done].reflectance;
    const float retro_gain = shading[done].retro_gain;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const bool mine = instance[i] == done;
      const float x = R[0] * hit.Ng_x[i] + R[3] * hit.Ng_y[i] + R[6] * hit.Ng_z[i];
      const float y = R[1] * hit.Ng_x[i] + R[4] * hit.Ng_y[i] + R[7] * hit.Ng_z[i];
      const float z = R[2] * hit.Ng_x[i] + R[5] * hit.Ng_y[i] + R[8] * hit.Ng_z[i];
      surfaces.normal_x[i] = mine ? x : surfaces.normal_x[i];
      surfaces.normal_y[i] = mine ? y : surfaces.normal_y[i];
      surfaces.normal_z[i] = mine ? z : surfaces.normal_z[i];
      surfaces.reflectance[i] = mine ? reflectance : surfaces.reflectance[i];
      surfaces.retro_gain[i] = mine ? retro_gain : surfaces.retro_gain[i];
    }
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x = surfaces.normal_x[i];
    const float y = surfaces.normal_y[i];
    const float z = surfaces.normal_z[i];
    // Cosine of incidence |n . d| / |n|.
    const float along = x * ray.dir_x[i] + y * ray.dir_y[i] + z * ray.dir_z[i];
    const float square = x * x + y * y + z * z;
    surfaces.cosine[i] = square > 0.0F ? std::abs(along) / std::sqrt(square) : 0.0F;
  }
}

void cover_reflectance(const Scene::Internals& scene, const RTCRayHit8& packet,
                       const SurfaceNumbers& surface, LaneArray& reflectance) {
  const RTCRay8& ray = packet.ray;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (surface[i] != RTC_INVALID_GEOMETRY_ID && scene.shading[surface[i]].cover != nullptr) {
      reflectance[i] = mean_reflectance(scene.shading[surface[i]], scene.origin_W,
                                        ray.org_x[i] + ray.tfar[i] * ray.dir_x[i],
                                        ray.org_y[i] + ray.tfar[i] * ray.dir_y[i]);
    }
  }
}

void vary_reflectance(const Scene::Internals& scene, const GrainLattice& lattice,
                      const RTCRayHit8& packet, LaneArray& reflectance) {
  const SurfaceNumbers surface(packet.hit);
  cover_reflectance(scene, packet, surface, reflectance);
  LaneArray variation;
  for (std::size_t i = 0; i < kLanes; ++i) {
    variation[i] =
        surface[i] != RTC_INVALID_GEOMETRY_ID ? scene.shading[surface[i]].variation : 0.0F;
  }
  grain_lanes(packet.ray, lattice, variation, reflectance);
}

float varied_reflectance(const Scene::Internals& scene, const GrainLattice& lattice,
                         std::uint32_t surface, const Eigen::Vector3f& p) {
  const Shading& met = scene.shading[surface];
  const float mean =
      met.cover != nullptr ? mean_reflectance(met, scene.origin_W, p.x(), p.y()) : met.reflectance;
  return met.variation > 0.0F ? grained(mean, met.variation, p.x(), p.y(), p.z(), lattice) : mean;
}

}  // namespace rigwire::sim
