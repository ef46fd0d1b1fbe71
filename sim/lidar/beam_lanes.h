// Arithmetic of eight beams side by side: their sub-rays and what comes back from them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/lidar/beam_hits.h"
#include "sim/lidar/echo_model.h"
#include "sim/lidar/hit_surface.h"
#include "sim/lidar/ray_lanes.h"

namespace rigwire::sim {

/// Unit vectors across the beams: right and up, looking along the beam.
struct Across {
  LaneArray right_x, right_y, right_z;
  LaneArray up_x, up_y, up_z;
};

/// `axis`: the sensor's z axis, x, y and z; not along any beam.
void look_across(const RTCRay8& middle, const std::array<LaneArray, 3>& axis, Across& across);

/// A sub-ray, in the plane across the beam at distance 1.
struct SubRayAim {
  float right = 0.0F;
  float up = 0.0F;
  float shrink = 1.0F;  ///< Makes the direction a unit vector again.
  float weight = 1.0F;
  float patch_right = 0.0F;  ///< Half the way to its neighbours.
  float patch_up = 0.0F;
};

/// Sub-rays of eight beams that are cast together: their directions and hits. Sub-ray i of beam k
/// is number i kLanes + k.
struct RayGroup {
  static constexpr std::size_t kMostSubRays = 25;
  struct alignas(32) Column : std::array<float, kMostSubRays * kLanes> {};

  Column x, y, z;  ///< Directions.
  Column range_m;  ///< SubRayHits::kNothing: nothing within reach.
  Column normal_x, normal_y, normal_z;
  Column cosine;
  Column reflectance;
  Column retro_gain;
};

/// Rays of a group that make a packet: number of the ray and of its beam in each lane.
struct RayChoice {
  alignas(32) std::array<std::int32_t, kLanes> ray{};
  alignas(32) std::array<std::int32_t, kLanes> beam{};
};

/// Sets the directions of one sub-ray.
void aim_rays(const RTCRay8& middle, const Across& across, const SubRayAim& aim,
              std::size_t sub_ray, RayGroup& group);

/// A packet ready to be cast.
void load_rays(const RTCRay8& middle, const RayGroup& group, const RayChoice& choice,
               RTCRayHit8& packet);

/// Stores a cast packet's hits in the group, at the places of its rays.
void store_hits(const RTCRayHit8& packet, const HitSurfaces& surfaces, const RayChoice& choice,
                RayGroup& group);

struct Reception {
  float minimum_m = 0.0F;              ///< Nearer surfaces stop light, but return no echo.
  bool retro_alone = false;            ///< Diffuse surfaces do not count.
  bool compensates_incidence = false;  ///< Brightness is that of the surface at normal incidence.
};

/// What comes back to one sub-ray in clear air.
void receive_hits(const RayGroup& group, std::size_t sub_ray, const Across& across,
                  const SubRayAim& aim, const Reception& reception, SubRayHits& hits);

/// Nearest and farthest of the hits that return something; SubRayHits::kNothing and 0: none does.
void find_extent(std::span<const SubRayHits> hits, LaneArray& near_m, LaneArray& far_m);

/// All hits of a beam as one echo, by the same sums as detect_echoes().
void sum_up(std::span<const SubRayHits> hits, const LaneArray& near_m, EchoLanes& echo);

}  // namespace rigwire::sim
