// What surfaces look like: colour, grain down to the pixel, relief, gloss and what light leaves let
// through. A scene's materials say what a surface is by their label, and how it answers to 905 nm;
// how a label looks is said here, by one of a few kinds.
//
// Colours are albedos by band (red, green, blue) of linear sRGB, of the order that field
// measurements give (ECOSTRESS spectral library, Meerdink et al. 2019: soils 0.1 .. 0.35, leaves
// 0.04 .. 0.12 in the visible, concrete 0.3 .. 0.4). Meshes of scenes carry no pictures as textures
// (triangle_mesh.h): paint is even but for dirt and wear.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fields/rules.h"

namespace rigwire::sim {

enum class SurfaceKind : std::uint8_t {
  gravel,
  litter,
  rock,
  grass,
  leaves,
  bark,
  asphalt,
  concrete,
  plaster,
  paint,
  rubber,
  steel,
  reflector,
};

/// How surfaces of a label look; every label that is not named has what is built in for it.
struct SurfaceLook {
  std::string label;
  SurfaceKind kind = SurfaceKind::paint;
  /// Albedo red, green, blue; all 0: the kind's own.
  Eigen::Vector3d colour = Eigen::Vector3d::Zero();

  friend bool operator==(const SurfaceLook&, const SurfaceLook&) = default;
};
void visit(fields::Visitor& v, SurfaceLook& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const SurfaceLook& look);

/// A surface as it is shaded.
struct Shade {
  float red = 0.3F, green = 0.3F, blue = 0.3F;     ///< Albedo of one tint,
  float red2 = 0.3F, green2 = 0.3F, blue2 = 0.3F;  ///< and of the other, blended in patches.
  float frequency_pm = 1.0F;  ///< Of the coarsest octave of the grain: one over its cell.
  float grain = 0.0F;         ///< Rms of one octave of brightness at the coarsest one.
  float persistence = 0.8F;   ///< Of the next finer one.
  float relief = 0.0F;        ///< Slope of one octave, from the third one on, all alike.
  float gloss = 0.0F;         ///< Reflectance of the coat, head on.
  float sharpness = 1.0F;     ///< Exponent of its lobe.
  float transmission = 0.0F;  ///< Share of the diffuse light that leaves on the other side.
  float variation = 0.0F;     ///< Rms difference in brightness from triangle to triangle.
  float soaks = 0.0F;         ///< 1: rain darkens it and lays a film of water over it.
};

[[nodiscard]] Shade shade_of(SurfaceKind kind);

/// By the label: from `looks` where it is there, else what is built in; a label that nobody knows
/// is paint as grey as `reflectance` says.
[[nodiscard]] Shade shade_of(std::string_view label, double reflectance,
                             const std::vector<SurfaceLook>& looks);

}  // namespace rigwire::sim
