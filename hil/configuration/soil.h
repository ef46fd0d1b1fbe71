// Keys of a soil (sim/ground/soil.h).
#pragma once

#include "fields/visitor.h"
#include "sim/ground/soil.h"

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::SoilParameters& p) {
  v.text("name", p.name, "By which regions call it.");
  v.number("friction", p.friction, fields::plain().between(0, 2), "Of rubber on it.");
  v.boolean("soft", p.soft, "Whether wheels sink in; only then the moduli below matter to them.");
  v.number("cohesion_modulus", p.cohesion_modulus, fields::plain().at_least(0),
           "k_c, N / m^(n+1).");
  v.number("friction_modulus", p.friction_modulus, fields::plain().above(0), "k_phi, N / m^(n+2).");
  v.number("exponent", p.exponent, fields::plain().between(0.3, 2), "n, of pressure over sinkage.");
  v.number("cohesion", p.cohesion_pa, fields::in("kPa").at_least(0),
           "Shear strength without load.");
  v.number("internal_friction", p.internal_friction_rad, fields::in("deg").at_least(0).at_most(89),
           "Angle by which shear strength grows with load.");
  v.number("shear_modulus", p.shear_modulus_m, fields::in("mm").above(0),
           "K of Janosi and Hanamoto: way to 63 % of the shear strength.");
  v.number("density", p.density_kgpm3, fields::in("kg/m3").above(0), "As it lies.");
  v.number("repose", p.repose_rad, fields::in("deg").above(0).at_most(89),
           "Steepest slope that stands.");
  v.number("adhesion", p.adhesion_pa, fields::in("kPa").at_least(0), "To steel.");
  v.number("tool_friction", p.tool_friction_rad, fields::in("deg").at_least(0).at_most(89),
           "Angle against steel.");
}

}  // namespace rigwire::sim
