// Light on eight points side by side, between the ray caster's calls.
//
//   L = albedo / pi (E_sun max(0, n.s) V + E_sky(n) (v + (1 - v) a)) + gloss
// n is the surface's normal bent by its relief, V whether the sun is seen, v the share of the sky
// that is seen, a the mean albedo around (what hides the sky is as bright as that share of the sky
// it hides). Leaves take light from both sides. Gloss: the lobe cos^n of J. F. Blinn ("Models of
// light reflection for computer synthesized pictures", SIGGRAPH 1977), normalized, its power as
// (1 - (1 - c) n / 16)^16, and the sky in the mirror's direction, blurred to nine spherical
// harmonics; both by the Fresnel term of C. Schlick (Eurographics 1994).
#pragma once

#include <embree3/rtcore.h>

#include <Eigen/Core>
#include <array>

#include "sim/camera/daylight.h"
#include "sim/camera/surface_grain.h"
#include "sim/camera/surface_look.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

/// A surface look made ready: its grain's lattice in the fixed scene.
struct PreparedLook {
  Shade shade;
  std::array<std::int32_t, 3> cell{};
  std::array<float, 3> share{};
};

/// Light as the lanes take it.
struct LightTerms {
  std::array<float, 3> to_sun{};
  std::array<float, 3> sun_lx{};
  std::array<std::array<float, 9>, 3> diffuse{};  ///< By band.
  float albedo_around = 0.2F;
  float wetness = 0.0F;
};
[[nodiscard]] LightTerms light_terms(const Daylight& light, double wetness);

/// Hits of eight rays. Rays without a hit get the position of one with a hit, so that lanes stay
/// alike, and a zero normal.
struct MetSurfaces {
  alignas(32) std::array<std::uint32_t, kLanes> number;  ///< surface_number().
  unsigned one = ~0U;    ///< Number of the only surface that was hit; ~0: several were.
  LaneArray x, y, z;     ///< Hit points, in Embree's coordinates.
  LaneArray range_m;     ///< Along the ray.
  LaneArray gx, gy, gz;  ///< Flat normals, unit, towards the viewer; 0 where nothing is.
  LaneArray nx, ny, nz;  ///< Smooth normals, the same unless they were replaced.
  LaneArray draw;        ///< -1 .. 1, of the triangle that was hit.

  std::uint32_t look = ~0U;  ///< Look of all lanes; ~0: they differ.
  LaneArray red, green, blue, red2, green2, blue2;
  LaneArray grain, relief, gloss, sharpness, transmission, variation, soaks, film;
  LaneArray stones, stone_red, stone_green, stone_blue;
  GrainPoints points;  ///< Where they are for their grain: in their body's own frame.
  GrainAnchor anchor;
};

/// Look of each lane; ~0 where nothing was hit.
struct alignas(32) LookLanes : std::array<std::uint32_t, kLanes> {};

/// Computes points, flat normals and draws of a cast packet's hits. Returns whether there are any.
bool meet_points(const Scene::Internals::Shading* shading, const RTCRayHit8& packet,
                 MetSurfaces& met);

/// Copies the looks to the lanes. Keeps those in `met` if all lanes have the look of the last call.
void take_looks(const PreparedLook* looks, const LookLanes& look, MetSurfaces& met);

/// A pixel's width on the surfaces, between that across and that along its slant.
void find_footprints(const RTCRayHit8& packet, const LaneArray& pixel_rad, MetSurfaces& met);

/// A point that is lit.
struct LitLanes {
  LaneArray nx, ny, nz;        ///< Bent by the relief.
  LaneArray red, green, blue;  ///< Albedo, grain in it.
  LaneArray gloss, sharpness;
  bool glossy = false;  ///< One of them is.
  LaneArray sun;        ///< Cosine of incidence, leaves from behind included; 0: no sun.
};

/// Albedos and normals with their grain and stones.
void texture(const MetSurfaces& met, const Grain& grain, const Stones& stones,
             const LightTerms& light, LitLanes& lit);

/// Rays towards the sun from points that it may light; `active` -1 there and 0 elsewhere. Returns
/// whether there is one.
bool aim_at_sun(const MetSurfaces& met, const LitLanes& lit, const RTCRayHit8& packet,
                const Eigen::Vector3f& to_sun, RTCRay8& rays, std::array<int, kLanes>& active);

/// Luminance, cd/m2. `seen`: share of the sun, `sky`: share of the sky.
void light_up(const MetSurfaces& met, const LitLanes& lit, const RTCRayHit8& packet,
              const LightTerms& light, const LaneArray& seen, const LaneArray& sky,
              std::array<LaneArray, 3>& luminance);

}  // namespace rigwire::sim
