// What a standing tree bears before it breaks or is uprooted, and how it gives before that.
//
// Breaking: modulus of rupture of the green stem times pi d^3 / 32 at the stump. Uprooting: a
// moment in proportion to the stem's mass, which goes with H d^2. The lesser of both is the
// strength. Sources: Lundstroem and Stoeckli, Tree Physiology 28 (2008) 355 (fresh spruce and fir,
// 43 .. 59 MPa less a tenth to a fifth for knots); Wood Handbook FPL-GTR-190, table 5-3a (green
// pine 35 .. 60 MPa); Byrne, thesis UBC 2005 (uprooting per kilogram of stem: pine 146, spruce 119
// N m/kg); Peltola et al., Forest Ecology and Management 135 (2000) 143 (which goes with what).
// Form factor 0.45 and 850 kg/m3 of green stem are estimates, as is broadleaf wood altogether.
#pragma once

#include "sim/ground/ground.h"

namespace rigwire::sim {

enum class Wood { spruce, pine, broadleaf };

/// N m about the foot, of a stem of that diameter at its foot and that height.
[[nodiscard]] double breaking_moment_nm(Wood wood, double diameter_m);
[[nodiscard]] double uprooting_moment_nm(Wood wood, double diameter_m, double height_m);

/// Sets strength, stiffness and tree of a trunk: the root plate's turn of 0.06 rad at the uprooting
/// moment (an estimate), felt 0.8 m above the ground, where machines push.
void root(Obstacle& trunk, Wood wood, double diameter_m, double height_m);

}  // namespace rigwire::sim
