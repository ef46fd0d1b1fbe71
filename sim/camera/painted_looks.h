// Textures of meshes at a ray packet's hits: albedos averaged over a pixel's footprint, across and
// along its slant separately (colour_texture.h).
#pragma once

#include <cstddef>

#include "sim/camera/shading_lanes.h"
#include "sim/camera/surface_look.h"
#include "sim/scene/painted_surface.h"

namespace rigwire::sim {

/// A label's shade on a mesh with a colour of its own: gloss, wetness and what shines through stay
/// the label's; its tints are the mesh's. Under a texture there is no grain, relief, stone or pane
/// but what the texture shows.
[[nodiscard]] Shade painted(Shade label, const MeshColour& colour);

/// At one lane, its albedo from the texture. `X`: the mesh in Embree's coordinates now, columns of
/// its linear part first, evenly scaled.
void paint(const PaintedSurface& surface, const float* X, const RTCRayHit8& rays, float pixel_rad,
           std::size_t lane, MetSurfaces& met);

}  // namespace rigwire::sim
