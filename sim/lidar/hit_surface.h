// What a packet of eight rays has hit, side by side.
#pragma once

#include <array>

#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

/// Where nothing was hit the surface reflects nothing.
struct SurfaceLanes {
  std::array<Lanes, 3> normal_W;  ///< Not of unit length, on either side.
  Lanes reflectance;
  Lanes retro_gain;
  bool any_retro = false;  ///< Otherwise retro_gain is 0 throughout.
};

[[nodiscard]] SurfaceLanes surfaces_of(const Scene::Internals& scene, const RTCRayHit8& packet);

/// |cos| of the angle between a ray and the normal of what it hit.
[[nodiscard]] Lanes cosine_of_incidence(const SurfaceLanes& surface, const RTCRayHit8& packet);

}  // namespace rigwire::sim
