// Keys of soils and of where they lie.
//
//   soils:
//     - name: gravel
//       friction: 0.6
//     - name: sand
//       soft: true
//   regions:
//     - {soil: sand, center: [10 m, 5 m], size: [20 m, 8 m]}
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"
#include "sim/ground/ground.h"
#include "sim/ground/soil.h"

namespace rigwire::hil {

/// A rectangle of terrain and what it is made of.
struct SoilRegion {
  std::string soil;                          ///< Name of one of the soils.
  std::array<double, 2> center_m{0.0, 0.0};  ///< [east, north]
  std::array<double, 2> size_m{1.0, 1.0};    ///< Along its own axes, before the turn.
  double yaw_rad = 0.0;
};

struct SoilConfiguration {
  std::vector<sim::SoilParameters> soils{sim::SoilParameters{}};  ///< The first lies everywhere.
  std::vector<SoilRegion> regions;                                ///< A later one lies on top.
};

/// Throws std::invalid_argument when there is no soil, two have one name, or a region names none.
inline void validate(const SoilConfiguration& p) {
  if (p.soils.empty() || p.soils.size() > 256) {
    throw std::invalid_argument("soils: " + std::to_string(p.soils.size()) +
                                " given, allowed: 1 .. 256");
  }
  const auto count = [&p](const std::string& name) {
    int found = 0;
    for (const sim::SoilParameters& soil : p.soils) {
      found += soil.name == name ? 1 : 0;
    }
    return found;
  };
  for (const sim::SoilParameters& soil : p.soils) {
    if (count(soil.name) > 1) {
      throw std::invalid_argument("soils: two are named '" + soil.name + "'");
    }
  }
  for (const SoilRegion& region : p.regions) {
    if (count(region.soil) == 0) {
      throw std::invalid_argument("regions: no soil is named '" + region.soil + "'");
    }
  }
}

/// The soils of each cell of the terrain, by the cell's middle.
inline sim::SoilMap soil_map(const SoilConfiguration& p, const sim::HeightField& field) {
  sim::SoilMap map{p.soils, {}};
  if (p.regions.empty()) {
    return map;
  }
  const std::size_t columns = field.columns - 1;
  map.cells.assign(columns * (field.rows - 1), 0);
  for (const SoilRegion& region : p.regions) {
    std::uint8_t soil = 0;
    while (p.soils[soil].name != region.soil) {
      ++soil;
    }
    const double cosine = std::cos(region.yaw_rad);
    const double sine = std::sin(region.yaw_rad);
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
      const double east = field.origin_m.x() - region.center_m[0] +
                          field.cell_m * (static_cast<double>(i % columns) + 0.5);
      const double north = field.origin_m.y() - region.center_m[1] +
                           field.cell_m * (static_cast<double>(i / columns) + 0.5);
      if (std::abs(cosine * east + sine * north) <= 0.5 * region.size_m[0] &&
          std::abs(cosine * north - sine * east) <= 0.5 * region.size_m[1]) {
        map.cells[i] = soil;
      }
    }
  }
  return map;
}

template <class Visitor>
void visit(Visitor& v, sim::SoilParameters& p) {
  v.text("name", p.name, "By which regions call it.");
  v.number("friction", p.friction, plain().between(0, 2), "Of rubber on it.");
  v.boolean("soft", p.soft, "Whether wheels sink in; only then the moduli below matter to them.");
  v.number("cohesion_modulus", p.cohesion_modulus, plain().at_least(0), "k_c, N / m^(n+1).");
  v.number("friction_modulus", p.friction_modulus, plain().above(0), "k_phi, N / m^(n+2).");
  v.number("exponent", p.exponent, plain().between(0.3, 2), "n, of pressure over sinkage.");
  v.number("cohesion", p.cohesion_pa, in("kPa").at_least(0), "Shear strength without load.");
  v.number("internal_friction", p.internal_friction_rad, in("deg").at_least(0).at_most(89),
           "Angle by which shear strength grows with load.");
  v.number("shear_modulus", p.shear_modulus_m, in("mm").above(0),
           "K of Janosi and Hanamoto: way to 63 % of the shear strength.");
  v.number("density", p.density_kgpm3, in("kg/m3").above(0), "As it lies.");
  v.number("repose", p.repose_rad, in("deg").above(0).at_most(89), "Steepest slope that stands.");
  v.number("adhesion", p.adhesion_pa, in("kPa").at_least(0), "To steel.");
  v.number("tool_friction", p.tool_friction_rad, in("deg").at_least(0).at_most(89),
           "Angle against steel.");
}

template <class Visitor>
void visit(Visitor& v, SoilRegion& p) {
  v.text("soil", p.soil, "Name of one of the soils.");
  v.numbers("center", p.center_m, in("m"), "[east, north].");
  v.numbers("size", p.size_m, in("m").above(0), "Along its own axes.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360), "Of its axes from east, left positive.");
}

template <class Visitor>
void visit(Visitor& v, SoilConfiguration& p) {
  v.list("soils", p.soils, "What the ground is made of; the first lies everywhere.");
  v.list("regions", p.regions, "Where another lies; a later one lies on top.");
}

}  // namespace rigwire::hil
