#include "sim/ground/earthmoving.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

using Range = EarthmovingRange;

// std::clamp hands a NaN through; this gives the lower end.
double within(double value, double least, double greatest) {
  return value > least ? std::min(value, greatest) : least;
}

}  // namespace

EarthmovingFactors earthmoving_factors(double internal_friction_rad, double tool_friction_rad,
                                       double rake_rad) {
  const double phi =
      within(internal_friction_rad, Range::kLeastFriction_rad, Range::kGreatestFriction_rad);
  const double delta = within(tool_friction_rad, 0.0, phi);
  const double rho = within(rake_rad, Range::kLeastRake_rad, Range::kGreatestSum_rad - delta - phi);
  const double sin_phi = std::sin(phi);
  const double cos_phi = std::cos(phi);
  const double sin_rake = std::sin(rho);
  const double cot_rake = std::cos(rho) / sin_rake;
  const double tilt = std::sin(rho + delta);
  const double a = std::sin(rho + delta + phi);
  const double b = std::cos(rho + delta + phi);
  // dN_gamma/d(cot beta) = 0: cot beta = (root - B) / A, root as in earthmoving.h.
  const double root = std::sqrt(std::sin(delta + phi) * tilt / (sin_phi * sin_rake));
  const double cot_beta = (root - b) / a;
  // den = (a t + b) / (sin phi t + cos phi), and a t + b = root: positive, between the poles.
  const double numerator = sin_phi * cot_beta + cos_phi;
  const double cot_sum = (cos_phi * cot_beta - sin_phi) / numerator;  // cot(beta + phi)
  const double inverse = numerator / root;

  EarthmovingFactors factors;
  // Reece 1964, McKyes 1985: N_gamma, N_q, N_c, N_a at that beta (earthmoving.h).
  factors.weight = 0.5 * (cot_rake + cot_beta) * inverse;
  factors.surcharge = 2.0 * factors.weight;
  factors.cohesion = (1.0 + cot_beta * cot_sum) * inverse;
  factors.adhesion = std::max(0.0, (1.0 - cot_rake * cot_sum) * inverse);
  factors.failure_angle_rad = std::atan2(1.0, cot_beta);
  return factors;
}

double earthmoving_force_n(const SoilParameters& soil, const EarthmovingFactors& factors,
                           double depth_m, double width_m, double surcharge_pa,
                           double gravity_mps2) {
  if (!(depth_m > 0.0) || !(width_m > 0.0)) {
    return 0.0;
  }
  // Fundamental earthmoving equation: P = (gamma g d^2 N_gamma + c d N_c + q d N_q + c_a d N_a) w.
  const double pressure = soil.density_kgpm3 * gravity_mps2 * depth_m * factors.weight +
                          soil.cohesion_pa * factors.cohesion +
                          std::max(0.0, surcharge_pa) * factors.surcharge +
                          soil.adhesion_pa * factors.adhesion;
  return std::max(0.0, pressure) * depth_m * width_m;
}

}  // namespace rigwire::sim
