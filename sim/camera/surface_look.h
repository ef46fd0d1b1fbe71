// What surfaces look like: colour, grain down to the pixel, relief, gloss and what light leaves let
// through. A scene's materials say what a surface is by their label, and how it answers to 905 nm;
// how a label looks is said here, by one of a few kinds.
//
// Colours are albedos by band (red, green, blue) of linear sRGB, of the order that field
// measurements give (ECOSTRESS spectral library, Meerdink et al. 2019: soils 0.1 .. 0.35, leaves
// 0.04 .. 0.12 in the visible, concrete 0.3 .. 0.4). Paint is even but for dirt and wear. Meshes
// with colours of their own (triangle_mesh.h) have those for their label's (painted_looks.h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fields/rules.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

enum class SurfaceKind : std::uint8_t {
  gravel,
  soil,
  mud,
  litter,
  rock,
  grass,
  leaves,
  canopy,
  bark,
  asphalt,
  concrete,
  plaster,
  facade,
  paint,
  rubber,
  cab,
  steel,
  glass,
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

/// Panes of glass in the upright sides of a thing, evenly over its length and its height: as many
/// as come nearest to the spacing.
struct Panes {
  float across_m = 0.0F;  ///< Spacing along a side; 0: none.
  float up_m = 3.2F;      ///< Spacing of rows.
  /// Edges of a pane, as shares of the spacing.
  float left = 0.24F, right = 0.76F, bottom = 0.30F, top = 0.80F;
};

/// By band.
struct Albedo {
  float red = 0.3F, green = 0.3F, blue = 0.3F;

  friend bool operator==(const Albedo&, const Albedo&) = default;
};

/// A surface as it is shaded.
struct Shade {
  Albedo one{}, two{};        ///< Two tints, blended in patches.
  float frequency_pm = 1.0F;  ///< One over the cell of the grain's coarsest octave.
  float upright = 1.0F;       ///< Ratio of its value along z: below 1 fibres, above 1 beds.
  float grain = 0.0F;         ///< Rms brightness of the coarsest octave.
  float persistence = 0.8F;   ///< Weight of an octave relative to the next coarser one.
  float relief = 0.0F;        ///< Slope of one octave, from the third one on, all alike.
  float gloss = 0.0F;         ///< Reflectance of the coat, head on.
  float sharpness = 1.0F;     ///< Exponent of its lobe.
  float transmission = 0.0F;  ///< Share of the diffuse light that leaves on the other side.
  float variation = 0.0F;     ///< Rms difference in brightness from triangle to triangle.
  float soaks = 0.0F;         ///< 1: rain darkens it.
  float film = 0.0F;          ///< Share of the wet surface under a film of water.
  float stones = 0.0F;        ///< Share of the lattice's cells with a stone in them, 0 .. 1.
  Albedo stone{};             ///< Mean of the stones.
  Panes panes{};
  /// Slope of terrain from which on it is bare: a cut face shows there; 0: nowhere.
  float bare_from = 0.0F;
};

/// What terrain shows where it is steeper than its surface holds.
[[nodiscard]] Shade cut_face();

[[nodiscard]] Shade shade_of(SurfaceKind kind);

/// Returns the shade of the material's label: from `looks` if it is there, else a built-in one; an
/// unknown label is paint as grey as the reflectance. Closed surfaces of foliage are canopy.
[[nodiscard]] Shade shade_of(const Material& material, const std::vector<SurfaceLook>& looks);

/// Returns the shade of a soil by its name, from `looks` or built in; nullopt if the name is
/// unknown: it then looks like the terrain's material.
[[nodiscard]] std::optional<Shade> shade_of_soil(std::string_view name,
                                                 const std::vector<SurfaceLook>& looks);

}  // namespace rigwire::sim
