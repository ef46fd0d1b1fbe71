#include "sim/scene/trunk_strength.h"

#include <algorithm>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr double kFormFactor = 0.45;
constexpr double kGreen_kgpm3 = 850.0;
constexpr double kRootTurn_rad = 0.06;
constexpr double kPushHeight_m = 0.8;

double rupture_pa(Wood wood) {
  return wood == Wood::spruce ? 38e6 : wood == Wood::pine ? 40e6 : 55e6;
}

double anchoring_nmpkg(Wood wood) {
  return wood == Wood::pine ? 146.0 : 119.0;
}

}  // namespace

double breaking_moment_nm(Wood wood, double diameter_m) {
  // sigma W, W = pi d^3 / 32 of the full circle.
  return rupture_pa(wood) * std::numbers::pi / 32.0 * diameter_m * diameter_m * diameter_m;
}

double uprooting_moment_nm(Wood wood, double diameter_m, double height_m) {
  const double stem_kg =
      kFormFactor * 0.25 * std::numbers::pi * diameter_m * diameter_m * height_m * kGreen_kgpm3;
  return anchoring_nmpkg(wood) * stem_kg;
}

void root(Obstacle& trunk, Wood wood, double diameter_m, double height_m) {
  const double uproot = uprooting_moment_nm(wood, diameter_m, height_m);
  trunk.strength_nm = std::min(breaking_moment_nm(wood, diameter_m), uproot);
  trunk.tree_height_m = height_m;
  // A turning spring at the foot seen at the height of the push: K / z^2.
  trunk.stiffness_npm = uproot / kRootTurn_rad / (kPushHeight_m * kPushHeight_m);
}

}  // namespace rigwire::sim
