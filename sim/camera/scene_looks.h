// Appearance of a scene's surfaces: material, normal, frame and texture at each of a ray packet's
// hits. Ground, panes of glass, textured meshes and moving things are handled separately
// (ground_looks.h, pane_looks.h, painted_looks.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/camera/ground_looks.h"
#include "sim/camera/painted_looks.h"
#include "sim/camera/pane_looks.h"
#include "sim/camera/shading_lanes.h"
#include "sim/camera/surface_grain.h"
#include "sim/camera/surface_look.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

/// Working memory for one packet after the other; what a packet leaves in it only saves work.
struct TexturedPacket {
  MetSurfaces met;
  LitLanes lit;

  bool on_bodies = false;                       ///< Some hit a moving body: X is set there.
  bool stony = false;                           ///< Some lanes have stones.
  bool glazed = false;                          ///< Some lanes have panes.
  bool painted = false;                         ///< Some lanes have a texture.
  std::array<std::array<float, 12>, kLanes> X;  ///< Poses of the links, column by column.
};

class SceneLooks {
 public:
  /// Prepares for the scene in its present slice. Looks in `given` replace built-in ones.
  void prepare(const Scene::Internals& scene, const std::vector<SurfaceLook>& given);

  /// Textures the hits of a cast packet. Returns whether it has any.
  bool texture_hits(const RTCRayHit8& rays, const LaneArray& pixel_rad, const LightTerms& light,
                    TexturedPacket& packet) const;

 private:
  /// By surface number (surface_number()).
  struct SurfaceInfo {
    std::uint16_t look = 0;
    std::uint8_t terrain = 0;  ///< 0: none; else its number plus 1.
    bool on_body = false;
    std::uint32_t panes = 0;    ///< 0: none; else the number of their frame plus 1.
    std::uint32_t painted = 0;  ///< 0: no texture; else Instance::painted.
  };

  std::uint16_t add(const Shade& shade);
  void find_looks(const RTCRayHit8& rays, const LaneArray& pixel_rad, TexturedPacket& packet) const;
  void paint_textures(const RTCRayHit8& rays, const LaneArray& pixel_rad,
                      TexturedPacket& packet) const;
  void follow_bodies(const RTCRayHit8& rays, TexturedPacket& packet) const;
  void turn_relief(const TexturedPacket& packet, Grain& grain) const;

  const Scene::Internals* scene_ = nullptr;
  std::vector<SurfaceInfo> infos_;
  std::vector<PreparedLook> looks_;
  std::vector<GroundLooks> grounds_;
  std::vector<PaneFrame> panes_;
  StoneAnchor stone_anchor_;
};

}  // namespace rigwire::sim
