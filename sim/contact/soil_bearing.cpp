#include "sim/contact/soil_bearing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

constexpr double kHard_pa = 2e6;
constexpr double kLeast_pa = 1e3;

}  // namespace

SoilBearing::SoilBearing(const SoilParameters& soil) {
  if (!soil.soft) {
    strength_pa_ = kHard_pa;
    return;
  }
  // Without internal friction N_c is its limit 2 + pi. No soil has more than 50 degrees.
  const double phi = std::min(soil.internal_friction_rad, 50.0 / 180.0 * std::numbers::pi);
  const double tangent = std::tan(phi);
  const double spread = std::tan(0.25 * std::numbers::pi + 0.5 * phi);
  const double n_q = std::exp(std::numbers::pi * tangent) * spread * spread;
  const double n_c = tangent > 1e-6 ? (n_q - 1.0) / tangent : 2.0 + std::numbers::pi;
  const double weight = kGravity_mps2 * soil.density_kgpm3;
  strength_pa_ = soil.cohesion_pa * n_c;
  by_depth_papm_ = weight * n_q;
  by_width_papm_ = weight * (n_q + 1.0) * tangent;
}

double SoilBearing::pressure_pa(double depth_m, double width_m) const {
  return std::max(kLeast_pa, strength_pa_ + by_depth_papm_ * depth_m + by_width_papm_ * width_m);
}

}  // namespace rigwire::sim
