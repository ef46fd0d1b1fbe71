#include "sim/lidar/hit_surface.h"

#include <cmath>

namespace rigwire::sim {

// Neighbours mostly meet the same instance: one after the other is worked out for all lanes, and
// each lane keeps what is its own.
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

}  // namespace rigwire::sim
