// What a packet of eight rays has met, side by side.
#pragma once

#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

/// Where nothing was met, cosine, reflectance and gain are 0.
struct HitSurfaces {
  LaneArray normal_x;  ///< In the world; of any length, on either side.
  LaneArray normal_y;
  LaneArray normal_z;
  LaneArray cosine;  ///< Of the incidence angle, 0 .. 1.
  LaneArray reflectance;
  LaneArray retro_gain;
};

/// `shading` by Embree's number of the instance (Scene::Internals::shading). The rays' directions
/// have unit length.
void meet_surfaces(const Scene::Internals::Shading* shading, const RTCRayHit8& packet,
                   HitSurfaces& surfaces);

}  // namespace rigwire::sim
