// Open terrain: rolling hills and level sites, by formula and noise.
#pragma once

#include "fields/rules.h"

#include <cstdint>

#include "sim/scene/height_field.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// A plane that rises in one direction: how steep, and towards where.
struct MeanSlope {
  double rise = 0.0;         ///< Rise over run.
  double uphill_rad = 0.0;   ///< Direction in which it rises, left from east.
  double height_at_0_m = 0;  ///< At (0, 0).

  [[nodiscard]] double height_m(double x_m, double y_m) const;
};
void visit(fields::Visitor& v, MeanSlope& p);

/// Rolling ground: a mean slope with fractal noise (sim/scene/noise_field.h) down to waves of two
/// cells.
struct HillsTerrain {
  static constexpr fields::Named kNamed{"hills", "Rolling ground."};

  double size_m = 240.0;  ///< Edge of the square area, its middle at (0, 0).
  double cell_m = 0.4;    ///< Distance of the nodes.
  MeanSlope slope;
  double roughness_m = 2.0;      ///< Standard deviation of the noise.
  double longest_wave_m = 90.0;  ///< Wave length of the noise's coarsest layer.
  Material material{.reflectance = 0.3, .label = "ground"};
};
void visit(fields::Visitor& v, HillsTerrain& p);

/// A level site with an optional crossfall.
struct LevelTerrain {
  static constexpr fields::Named kNamed{"level", "A level site, with a crossfall if wanted."};

  double size_m = 240.0;
  double cell_m = 0.5;
  MeanSlope slope;
  double roughness_m = 0.004;  ///< Standard deviation of the noise, waves of 3 m and shorter.
  Material material{.reflectance = 0.25, .label = "ground"};
};
void visit(fields::Visitor& v, LevelTerrain& p);

/// Throw std::invalid_argument naming the key, the value and what is allowed.
void validate(const HillsTerrain& terrain);
void validate(const LevelTerrain& terrain);

/// Return heights that depend on the parameters and the seed alone. Validate.
[[nodiscard]] HeightField make_hills(const HillsTerrain& terrain, std::uint64_t seed);
[[nodiscard]] HeightField make_level(const LevelTerrain& terrain, std::uint64_t seed);

}  // namespace rigwire::sim
