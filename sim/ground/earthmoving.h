// Passive earth pressure on a flat blade that is pushed through soil, the fundamental earthmoving
// equation, in closed form.
//
// A plane wedge of soil slides up along a failure plane at angle beta, in front of a blade of width
// w whose edge is d below the surface:
//
//     P = (gamma g d^2 N_gamma + c d N_c + q d N_q + c_a d N_a) w
//
// Source: A. R. Reece, "The fundamental equation of earth-moving mechanics", Proc. Inst. Mech.
// Engrs 179 (3F), 1964; E. McKyes, Soil Cutting and Tillage, 1985. With rake rho (blade against
// the direction of travel: 90 degrees upright, less when it lifts the soil), tool friction delta,
// internal friction phi:
//
//     den     = cos(rho + delta) + sin(rho + delta) cot(beta + phi)
//     N_gamma = (cot rho + cot beta) / (2 den)            N_q = 2 N_gamma
//     N_c     = (1 + cot beta cot(beta + phi)) / den      N_a = (1 - cot rho cot(beta + phi)) / den
//
// beta is the angle that needs the minimum force, where N_gamma is minimal. No search is made: with
// t = cot beta, N_gamma = (cot rho + t)(sin phi t + cos phi) / (2 (A t + B)), A = sin psi,
// B = cos psi, psi = rho + delta + phi, and dN/dt = 0 is a quadratic whose root between the poles
// is
//
//     cot beta = (sqrt(sin(delta + phi) sin(rho + delta) / (sin phi sin rho)) - B) / A.
//
// The tests hold it against a grid search (equal to 1e-12).
//
// Limits. No weight of a heap in front (raise the surface instead), plane strain (no side wedges),
// quasi-static. Against particle models such forces are within 10 to 25 % once fitted (M. Servin
// and others, Adv. Model. Simul. Eng. Sci. 8:11, 2021); unfitted soils scatter by more.
#pragma once

#include "sim/ground/soil.h"

namespace rigwire::sim {

struct EarthmovingFactors {
  double weight = 0.0;             ///< N_gamma.
  double cohesion = 0.0;           ///< N_c.
  double surcharge = 0.0;          ///< N_q.
  double adhesion = 0.0;           ///< N_a, never negative.
  double failure_angle_rad = 0.0;  ///< beta, angle of the failure plane against the horizontal.
};

/// Ranges within which the equation is evaluated; angles outside are clamped to the nearest end, so
/// that the factors are finite and positive for all input. A blade flatter than the minimum rake
/// cuts as at the minimum; one leaning so far forward that rho + delta + phi would exceed the
/// maximum carries a dead wedge of soil and cuts with that wedge's face.
struct EarthmovingRange {
  static constexpr double kLeastFriction_rad = 0.0175;     ///< Lower limit of phi, 1 degree.
  static constexpr double kGreatestFriction_rad = 0.9599;  ///< Upper limit of phi, 55 degrees.
  static constexpr double kLeastRake_rad = 0.0873;         ///< 5 degrees.
  static constexpr double kGreatestSum_rad = 2.7925;       ///< rho + delta + phi, 160 degrees.
};

/// delta counts up to phi: steel never grips better than the soil itself. An angle that is not a
/// number is taken at its lower end.
[[nodiscard]] EarthmovingFactors earthmoving_factors(double internal_friction_rad,
                                                     double tool_friction_rad, double rake_rad);

/// Returns P, newtons, at least 0; 0 for a depth or width that is not positive. P acts on the blade
/// against its motion while it moves forward, and not when it is withdrawn: the caller decides that
/// (sim/excavator/bucket_soil.h).
[[nodiscard]] double earthmoving_force_n(const SoilParameters& soil,
                                         const EarthmovingFactors& factors, double depth_m,
                                         double width_m, double surcharge_pa, double gravity_mps2);

}  // namespace rigwire::sim
