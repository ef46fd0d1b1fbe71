#include "sim/tyre/tyre.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kLeastPressure_pa = 1.0e4;  // a flat tyre still has its carcass
constexpr double kLeastShare = 1e-3;         // of the reference load, keeps stiffnesses above 0
/// Angle over which the rolling resistance winds up; small against every turn that matters.
constexpr double kRollingWind_rad = 0.02;
/// Share of the reference load below which the vertical damper fades, so that a wheel that meets an
/// edge or lands feels no blow from it.
constexpr double kDampedShare = 0.25;
constexpr double kPrecision = 1e-13;  // of the sinkage, per overlap

}  // namespace

void visit(fields::Visitor& v, TyreParameters& p) {
  v.number("unloaded_radius", p.unloaded_radius_m, in("m").above(0).at_most(100),
           "Radius without load.");
  v.number("width", p.width_m, in("m").above(0).at_most(100), "Width of the tread.");
  v.number("rim_radius", p.rim_radius_m, in("m").above(0).at_most(100),
           "Radius at which the tyre bottoms.");
  v.number("carcass_stiffness", p.carcass_stiffness_npm, in("kN/m").at_least(0),
           "Vertical stiffness without pressure.");
  v.number("stiffness_per_pressure", p.stiffness_per_pressure_m, plain().at_least(0),
           "Vertical stiffness that each pascal of pressure adds, N/m per Pa.");
  v.number("vertical_damping", p.vertical_damping_nspm, in("N s/m").at_least(0),
           "Vertical damping of the tyre on the ground.");
  v.number("bottoming_factor", p.bottoming_factor, plain().at_least(0),
           "Stiffness on the rim, times that of the tyre.");
  v.number("reference_load", p.reference_load_n, in("kN").above(0),
           "Load at which the slip stiffnesses hold; they go with the load.");
  v.number("reference_pressure", p.reference_pressure_pa, in("bar").at_least(0.1),
           "Pressure at which the rolling resistance holds.");
  v.number("slip_stiffness", p.slip_stiffness_n, in("kN").above(0),
           "Longitudinal force per slip of 1, at small slip.");
  v.number("cornering_stiffness", p.cornering_stiffness_nprad, in("N/rad").above(0),
           "Lateral force per slip angle, at small angles.");
  v.number("longitudinal_stiffness", p.longitudinal_stiffness_npm, in("kN/m").above(0),
           "Stiffness of the standing tyre along its heading.");
  v.number("lateral_stiffness", p.lateral_stiffness_npm, in("kN/m").above(0),
           "Stiffness of the standing tyre across its heading.");
  v.number("damping_ratio", p.damping_ratio, plain().at_least(0),
           "Damping ratio along and across, with the mass that the wheel carries.");
  v.number("friction_factor", p.friction_factor, plain().at_least(0),
           "Factor on the ground's coefficient of friction.");
  v.number("rolling_resistance", p.rolling_resistance, plain().between(0, 0.99),
           "Coefficient of rolling resistance on hard ground at the reference pressure.");
  v.number("rolling_pressure_share", p.rolling_pressure_share, plain().between(0, 1),
           "Share of the rolling resistance that goes with 1 / pressure.");
}

void validate(const TyreParameters& p) {
  fields::check(p);
  fields::require(p.rim_radius_m <= p.unloaded_radius_m, "rim_radius",
                  in("m").print(p.rim_radius_m),
                  "at most unloaded_radius, " + in("m").print(p.unloaded_radius_m));
  fields::require(p.carcass_stiffness_npm + p.stiffness_per_pressure_m > 0.0, "carcass_stiffness",
                  in("kN/m").print(p.carcass_stiffness_npm),
                  "> 0 kN/m where stiffness_per_pressure is 0");
}

Tyre::Tyre(const TyreParameters& parameters, double carried_mass_kg)
    : parameters_(parameters), carried_mass_kg_(carried_mass_kg) {
  validate(parameters_);
  if (!std::isfinite(carried_mass_kg) || !(carried_mass_kg > 0.0)) {
    throw std::invalid_argument("tyre: carried_mass_kg is " + std::to_string(carried_mass_kg) +
                                ", allowed: greater than 0");
  }
}

double Tyre::stiffness_npm(double pressure_pa) const {
  return parameters_.carcass_stiffness_npm +
         parameters_.stiffness_per_pressure_m * std::max(0.0, pressure_pa);
}

TyreSpring Tyre::spring(double overlap_m, const SoilParameters* soft, double pressure_pa) const {
  const TyreParameters& p = parameters_;
  const double k = stiffness_npm(pressure_pa);
  const double to_rim = p.unloaded_radius_m - p.rim_radius_m;
  // Linear k(p) d; past the rim a second spring of bottoming_factor k(p) beside it.
  const auto on_hard = [&](double deflection) {
    const double beyond = std::max(0.0, deflection - to_rim);
    const double slope = k * (1.0 + (beyond > 0.0 ? p.bottoming_factor : 0.0));
    return TyreSpring{k * (deflection + p.bottoming_factor * beyond), slope, 0.0};
  };
  if (soft == nullptr || !(overlap_m > 0.0)) {
    return on_hard(std::max(0.0, overlap_m));
  }
  // Two springs in a row: the sinkage z at which tyre and soil carry the same load. The tyre's load
  // falls with z, so that the root of z - sinkage(tyre(overlap - z)) is the only one.
  const double diameter = 2.0 * p.unloaded_radius_m;
  const double carcass_pa =
      p.stiffness_per_pressure_m > 0.0 ? p.carcass_stiffness_npm / p.stiffness_per_pressure_m : 0.0;
  // A tyre softer than the ground flattens at its own pressure and sinks no deeper.
  const double flat = plate_sinkage_m(*soft, std::max(0.0, pressure_pa) + carcass_pa, p.width_m);
  const double exponent = std::clamp(soft->exponent, 0.3, 2.0) + 0.5;
  const double load_at_1m = wheel_load_n(*soft, 1.0, p.width_m, diameter);
  // Newton's rule within a bracket: the soil's load less the tyre's grows with z.
  double low = 0.0;
  double high = std::min(overlap_m, flat);
  double z = high;
  double soil_load = load_at_1m * std::pow(z, exponent);
  TyreSpring tyre = on_hard(overlap_m - z);
  const bool flattened = flat < overlap_m && soil_load <= tyre.force_n;
  for (int i = 0; i < 50 && !flattened; ++i) {
    const double excess = soil_load - tyre.force_n;
    (excess > 0.0 ? high : low) = z;
    const double change = excess / (exponent * soil_load / z + tyre.slope_npm);
    if (std::abs(change) < kPrecision * overlap_m || high - low < kPrecision * overlap_m) {
      break;
    }
    const double next = z - change;
    z = next > low && next < high ? next : 0.5 * (low + high);
    soil_load = load_at_1m * std::pow(z, exponent);
    tyre = on_hard(overlap_m - z);
  }
  tyre.sinkage_m = z;
  if (!flattened) {
    const double soil_slope = exponent * soil_load / std::max(z, 1e-12);
    // Slope of two springs in a row, k1 k2 / (k1 + k2).
    tyre.slope_npm *= soil_slope / (soil_slope + tyre.slope_npm);
  }
  return tyre;
}

TyreLaws Tyre::laws(double h, const std::optional<WheelContact>& contact,
                    const SoilParameters& soil, double pressure_pa, double rolling_speed_mps) {
  TyreLaws laws;
  if (!contact || !(contact->depth_m > 0.0)) {
    along_.reset();
    across_.reset();
    turning_.reset();
    last_slip_ = 0.0;
    last_rate_radps_ = 0.0;
    return laws;
  }
  const TyreParameters& p = parameters_;
  const double pressure = std::max(kLeastPressure_pa, pressure_pa);
  const SoilParameters* soft = soil.soft && !contact->ground.obstacle ? &soil : nullptr;
  const TyreSpring vertical = spring(contact->depth_m, soft, pressure_pa);
  const double load = vertical.force_n;
  const double deflection = contact->depth_m - vertical.sinkage_m;

  laws.touching = true;
  laws.sinkage_m = vertical.sinkage_m;
  laws.rolling_speed_mps = std::abs(rolling_speed_mps);
  // F = k(p) d + c d', linear in the centre's speed away from the ground at the step's end.
  const double damped = std::min(1.0, load / (kDampedShare * p.reference_load_n));
  laws.normal = {load, vertical.slope_npm * h + damped * p.vertical_damping_nspm};
  laws.rolling_radius_m = std::max(p.unloaded_radius_m - deflection, 0.5 * p.rim_radius_m);

  // Friction, and how the soil's shear softens the bristles.
  const double share = std::max(kLeastShare, load / p.reference_load_n);
  double slip_stiffness = share * p.slip_stiffness_n;
  double cornering_stiffness = share * p.cornering_stiffness_nprad;
  laws.along.stiffness = share * p.longitudinal_stiffness_npm;
  laws.across.stiffness = share * p.lateral_stiffness_npm;
  laws.friction = p.friction_factor * contact->ground.friction;
  double compaction_n = 0.0;
  if (soft != nullptr) {
    const double area = contact_area_m2(deflection);
    const double length = area / p.width_m;
    // Mohr-Coulomb's A c + W tan(phi), where that is less than the surface's own friction.
    const double carried = area * soft->cohesion_pa + load * std::tan(soft->internal_friction_rad);
    if (carried < laws.friction * load) {
      laws.friction = std::tan(soft->internal_friction_rad);
      laws.cohesion_n = area * soft->cohesion_pa;
    }
    const double shear_limit = std::max(laws.limit_n(load), 1e-3);
    // Secant of Janosi's curve at the last step's slip, in a row with the tyre's own slip.
    const double slip = std::max(last_slip_, 1e-6);
    const double yielding =
        slip / (shear_limit * std::max(shear_share(*soft, slip, length), 1e-12));
    slip_stiffness = 1.0 / (1.0 / slip_stiffness + yielding);
    cornering_stiffness = 1.0 / (1.0 / cornering_stiffness + yielding);
    // Janosi's initial slope, limit / K, in a row with the bristles.
    const double shearing = soft->shear_modulus_m / shear_limit;
    laws.along.stiffness = 1.0 / (1.0 / laws.along.stiffness + shearing);
    laws.across.stiffness = 1.0 / (1.0 / laws.across.stiffness + shearing);
    // Bekker's work of pressing the rut, per metre (soil.h).
    compaction_n = compaction_resistance_n(*soft, vertical.sinkage_m, p.width_m);
  }
  // sigma = slip stiffness / bristle stiffness (bristle.h); damping c = 2 zeta sqrt(k m).
  laws.along.relaxation_length = slip_stiffness / laws.along.stiffness;
  laws.across.relaxation_length = cornering_stiffness / laws.across.stiffness;
  const auto damping = [&](double stiffness, double inertia) {
    return 2.0 * p.damping_ratio * std::sqrt(stiffness * inertia);
  };
  laws.along.damping = damping(laws.along.stiffness, carried_mass_kg_);
  laws.across.damping = damping(laws.across.stiffness, carried_mass_kg_);
  laws.longitudinal = along_.force(laws.along, h, laws.rolling_speed_mps);
  laws.lateral = across_.force(laws.across, h, laws.rolling_speed_mps);

  // Rolling resistance: hysteresis of the tyre, compaction of the soil.
  const double resistance =
      p.rolling_resistance * (1.0 - p.rolling_pressure_share +
                              p.rolling_pressure_share * p.reference_pressure_pa / pressure);
  // Moment f R N with f = f0 (1 - share + share p0 / p); compaction adds R_c R to it.
  laws.rolling_arm_m = resistance * laws.rolling_radius_m;
  if (load > 0.0) {
    laws.rolling_arm_m += compaction_n * laws.rolling_radius_m / load;
  }
  const double radius2 = laws.rolling_radius_m * laws.rolling_radius_m;
  laws.turning.stiffness =
      std::max(laws.rolling_arm_m * load, 1e-6 * p.reference_load_n) / kRollingWind_rad;
  laws.turning.damping = damping(laws.turning.stiffness, carried_mass_kg_ * radius2);
  laws.rolling = turning_.force(laws.turning, h, 0.0);
  // While it turns, the secant of the limited law: the bristle's own slope would stop the wheel in
  // the first solve, and the machine would find its tangential limit on the wrong side.
  const double held = std::abs(laws.rolling.at(last_rate_radps_));
  const double limit = laws.rolling_arm_m * load;
  if (held > limit) {
    laws.rolling.offset *= limit / held;
    laws.rolling.gain *= limit / held;
    laws.turning_yields = true;
  }
  return laws;
}

void Tyre::settle(double h, const TyreLaws& laws, const TyreResult& result) {
  if (!laws.touching) {
    return;
  }
  if (result.slipping) {
    along_.yield(laws.along, result.longitudinal_n);
    across_.yield(laws.across, result.lateral_n);
  } else {
    along_.slide(laws.along, h, laws.rolling_speed_mps, result.longitudinal_slide_mps);
    across_.slide(laws.across, h, laws.rolling_speed_mps, result.lateral_slide_mps);
  }
  if (result.rolling_limited || laws.turning_yields) {
    turning_.yield(laws.turning, result.rolling_nm);
  } else {
    turning_.slide(laws.turning, h, 0.0, result.wheel_rate_radps);
  }
  last_rate_radps_ = result.wheel_rate_radps;
  // Slip for the next step's secant: sliding over rolling speed, capped.
  const double sliding = std::sqrt(result.longitudinal_slide_mps * result.longitudinal_slide_mps +
                                   result.lateral_slide_mps * result.lateral_slide_mps);
  constexpr double kGreatestSlip = 10.0;
  last_slip_ = sliding < kGreatestSlip * laws.rolling_speed_mps
                   ? sliding / laws.rolling_speed_mps
                   : (sliding > 0.0 && laws.rolling_speed_mps > 0.0 ? kGreatestSlip : 0.0);
}

double Tyre::contact_area_m2(double deflection_m) const {
  const TyreParameters& p = parameters_;
  // Chord of the flattened circle, 2 sqrt(d (2 R - d)), times width; at most load / pressure.
  const double chord =
      2.0 * std::sqrt(std::max(0.0, deflection_m * (2.0 * p.unloaded_radius_m - deflection_m)));
  const double whole = chord * p.width_m;
  return p.stiffness_per_pressure_m > 0.0
             ? std::min(whole, p.stiffness_per_pressure_m * std::max(0.0, deflection_m))
             : whole;
}

}  // namespace rigwire::sim
