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
/// Way over which the soil's resistance does.
constexpr double kPloughingWind_m = 0.01;
/// Share of the reference load below which the vertical damper fades, so that a wheel that hits an
/// edge or lands gets no impact from it.
constexpr double kDampedShare = 0.25;
constexpr double kPrecision = 1e-13;  // of the load

/// While it moves, the secant of a limited law: the bristle's own slope would stop the motion in
/// the first solve, and the machine would find its tangential limit on the wrong side.
bool yields(ImplicitForce& law, double last_speed, double limit) {
  const double held = std::abs(law.at(last_speed));
  if (!(held > limit)) {
    return false;
  }
  law.offset *= limit / held;
  law.gain *= limit / held;
  return true;
}

}  // namespace

void visit(fields::Visitor& v, TyreParameters& p) {
  v.number("unloaded_radius", p.unloaded_radius_m, in("m").between(0.001, 100),
           "Radius without load.");
  v.number("width", p.width_m, in("m").between(0.001, 100), "Width of the tread.");
  v.number("rim_radius", p.rim_radius_m, in("m").between(0.001, 100),
           "Radius at which the tyre bottoms.");
  v.number("carcass_stiffness", p.carcass_stiffness_npm, in("kN/m").between(0, 1e9),
           "Vertical stiffness without pressure.");
  v.number("stiffness_per_pressure", p.stiffness_per_pressure_m, plain().between(0, 1e6),
           "Vertical stiffness that each pascal of pressure adds, N/m per Pa.");
  v.number("vertical_damping", p.vertical_damping_nspm, in("N s/m").between(0, 1e9),
           "Vertical damping of the tyre on the ground.");
  v.number("bottoming_factor", p.bottoming_factor, plain().between(0, 1e6),
           "Stiffness on the rim, times that of the tyre.");
  v.number("reference_load", p.reference_load_n, in("kN").between(0.001, 1e6),
           "Load at which the slip stiffnesses hold.");
  v.number("reference_pressure", p.reference_pressure_pa, in("bar").between(0.1, 1000),
           "Pressure at which the rolling resistance holds.");
  v.number("slip_stiffness", p.slip_stiffness_n, in("kN").between(0.001, 1e6),
           "Longitudinal force per slip of 1, at small slip.");
  v.number("cornering_stiffness", p.cornering_stiffness_nprad, in("N/rad").between(1, 1e9),
           "Lateral force per slip angle, at small angles and reference_load.");
  v.number("cornering_peak_load", p.cornering_peak_load_n, in("kN").between(0.001, 1e6),
           "Load at which the cornering stiffness is greatest.");
  v.number("longitudinal_stiffness", p.longitudinal_stiffness_npm, in("kN/m").between(0.001, 1e9),
           "Stiffness of the standing tyre along its heading.");
  v.number("lateral_stiffness", p.lateral_stiffness_npm, in("kN/m").between(0.001, 1e9),
           "Stiffness of the standing tyre across its heading.");
  v.number("damping_ratio", p.damping_ratio, plain().between(0, 1e6),
           "Damping ratio along and across, with the mass that the wheel carries.");
  v.number("friction_factor", p.friction_factor, plain().between(0, 1e6),
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

double effective_radius_m(const TyreParameters& p, double deflection_m) {
  // R sin(phi) / phi to second order (tyre.h).
  return std::max(p.unloaded_radius_m - deflection_m / 3.0, 0.5 * p.rim_radius_m);
}

Tyre::Tyre(const TyreParameters& parameters, double carried_mass_kg)
    : parameters_(parameters), carried_mass_kg_(carried_mass_kg) {
  validate(parameters_);
  if (!std::isfinite(carried_mass_kg) || !(carried_mass_kg > 0.0)) {
    throw std::invalid_argument("tyre: the carried mass is out of range, found " +
                                std::to_string(carried_mass_kg) + " kg, allowed above 0 kg");
  }
}

double Tyre::stiffness_npm(double pressure_pa) const {
  return parameters_.carcass_stiffness_npm +
         parameters_.stiffness_per_pressure_m * std::max(0.0, pressure_pa);
}

double Tyre::ground_pressure_pa(double pressure_pa) const {
  // The carcass carries as much as air of its stiffness would.
  return std::max(0.0, pressure_pa) +
         (parameters_.stiffness_per_pressure_m > 0.0
              ? parameters_.carcass_stiffness_npm / parameters_.stiffness_per_pressure_m
              : 0.0);
}

SoilCurves Tyre::curves(const SoftSoils& soils, double pressure_pa) const {
  SoilCurves result;
  const double pressure = ground_pressure_pa(pressure_pa);
  for (std::size_t i = 0; i < soils.count; ++i) {
    result.curve[i] = SinkageCurve(*soils.soil[i], parameters_.width_m,
                                   2.0 * parameters_.unloaded_radius_m, pressure, soils.pressed_m);
    result.share[i] = soils.share[i];
  }
  result.count = soils.count;
  return result;
}

SinkageCurve::Point SoilCurves::at(double load_n) const {
  SinkageCurve::Point sum;
  for (std::size_t i = 0; i < count; ++i) {
    const SinkageCurve::Point point = curve[i].at(load_n);
    sum.sinkage_m += share[i] * point.sinkage_m;
    sum.slope_mpn += share[i] * point.slope_mpn;
  }
  return sum;
}

TyreSpring Tyre::spring(double overlap_m, const SoftSoils& soils, double pressure_pa) const {
  return spring(overlap_m, curves(soils, pressure_pa), pressure_pa, 0.0);
}

TyreSpring Tyre::spring(double overlap_m, const SoilCurves& soil, double pressure_pa,
                        double guess_n) const {
  const TyreParameters& p = parameters_;
  const double k = stiffness_npm(pressure_pa);
  const double to_rim = p.unloaded_radius_m - p.rim_radius_m;
  // Linear k(p) d; past the rim a second spring of bottoming_factor k(p) beside it.
  const auto on_hard = [&](double deflection) {
    const double beyond = std::max(0.0, deflection - to_rim);
    const double slope = k * (1.0 + (beyond > 0.0 ? p.bottoming_factor : 0.0));
    return TyreSpring{k * (deflection + p.bottoming_factor * beyond), slope, 0.0};
  };
  if (soil.count == 0 || !(overlap_m > 0.0)) {
    return on_hard(std::max(0.0, overlap_m));
  }
  const double rut = soil.at(0.0).sinkage_m;
  if (overlap_m <= rut) {
    return {0.0, 0.0, overlap_m};  // Above the floor of its rut.
  }
  // Two springs in a row: the load N at which deflection(N) + sinkage(N) is the overlap. Both grow
  // with N, so that there is one root; Newton's rule within a bracket finds it.
  double low = 0.0;
  double high = on_hard(overlap_m - rut).force_n;
  double load = guess_n > 0.0 && guess_n < high ? guess_n : 0.5 * high;
  SinkageCurve::Point ground = soil.at(load);
  for (int i = 0; i < 60; ++i) {
    const double beyond = load / k - to_rim;
    const double deflection =
        beyond > 0.0 ? to_rim + beyond / (1.0 + p.bottoming_factor) : load / k;
    const double yielding = (beyond > 0.0 ? 1.0 / (1.0 + p.bottoming_factor) : 1.0) / k;
    const double excess = deflection + ground.sinkage_m - overlap_m;
    (excess > 0.0 ? high : low) = load;
    const double change = excess / (yielding + ground.slope_mpn);
    if (std::abs(change) < kPrecision * load || high - low < kPrecision * load) {
      break;
    }
    const double next = load - change;
    // On the softest ground the load is orders below that on hard ground.
    load = next > low && next < high ? next : (low > 0.0 ? 0.5 * (low + high) : 0.05 * high);
    ground = soil.at(load);
  }
  TyreSpring result = on_hard(std::max(0.0, overlap_m - ground.sinkage_m));
  result.sinkage_m = ground.sinkage_m;
  // Slope of two springs in a row, 1 / (1 / k1 + 1 / k2).
  result.slope_npm /= 1.0 + result.slope_npm * ground.slope_mpn;
  return result;
}

double Tyre::overlap_m(double load_n, const SoftSoils& soils, double pressure_pa) const {
  const double k = stiffness_npm(pressure_pa);
  const double to_rim = parameters_.unloaded_radius_m - parameters_.rim_radius_m;
  const double beyond = std::max(0.0, load_n / k - to_rim);
  return load_n / k - beyond * (1.0 - 1.0 / (1.0 + parameters_.bottoming_factor)) +
         curves(soils, pressure_pa).at(load_n).sinkage_m;
}

TyreLaws Tyre::laws(double h, const std::optional<WheelContact>& contact,
                    const WheelFooting& footing, double pressure_pa, double rolling_speed_mps) {
  TyreLaws laws;
  if (!contact || !(contact->depth_m > 0.0)) {
    along_.reset();
    across_.reset();
    turning_.reset();
    ploughing_.reset();
    last_grip_ = 0.0;
    last_slip_ = 0.0;
    last_rate_radps_ = 0.0;
    last_way_mps_ = 0.0;
    return laws;
  }
  const TyreParameters& p = parameters_;
  const double pressure = std::max(kLeastPressure_pa, pressure_pa);
  const SoftSoils& soils = footing.under;
  const SoilCurves under = curves(soils, pressure_pa);
  const TyreSpring vertical = spring(contact->depth_m, under, pressure_pa, last_load_n_);
  const double load = vertical.force_n;
  last_load_n_ = load;
  const double deflection = contact->depth_m - vertical.sinkage_m;

  laws.touching = true;
  laws.sinkage_m = vertical.sinkage_m;
  laws.rolling_speed_mps = std::abs(rolling_speed_mps);
  // F = k(p) d + c d', linear in the centre's speed away from the ground at the step's end.
  const double damped = std::min(1.0, load / (kDampedShare * p.reference_load_n));
  laws.normal = {load, vertical.slope_npm * h + damped * p.vertical_damping_nspm};
  laws.loaded_radius_m = std::max(p.unloaded_radius_m - deflection, 0.5 * p.rim_radius_m);
  laws.rolling_radius_m = effective_radius_m(p, deflection);

  // Friction, and how the soil's shear softens the bristles.
  const double share = std::max(kLeastShare, load / p.reference_load_n);
  double slip_stiffness = share * p.slip_stiffness_n;
  // sin(2 atan(x)) = 2 x / (1 + x^2) against the same at the reference load.
  const double peak = p.reference_load_n / p.cornering_peak_load_n;
  double cornering_stiffness = share * p.cornering_stiffness_nprad * (1.0 + peak * peak) /
                               (1.0 + share * peak * share * peak);
  laws.along.stiffness = share * p.longitudinal_stiffness_npm;
  laws.across.stiffness = share * p.lateral_stiffness_npm;
  laws.friction = p.friction_factor * contact->ground.friction;
  double resistance_n = 0.0;
  if (soils.count > 0) {
    const double soft = soils.whole_share();
    laws.rut_m = vertical.sinkage_m / soft;
    laws.pressed_m = soils.pressed_m;
    const double length = contact_length_m(deflection, vertical.sinkage_m);
    const double area = length * p.width_m;
    // Mohr-Coulomb's A c + W tan(phi) of each soil, rubber's friction on what is hard; where that
    // is less than the surface's own friction everywhere.
    double slope = (1.0 - soft) * laws.friction;
    double cohesion = 0.0;
    double shear_modulus = 0.0;
    for (std::size_t i = 0; i < soils.count; ++i) {
      const SoilParameters& soil = *soils.soil[i];
      slope += soils.share[i] * std::tan(soil.internal_friction_rad);
      cohesion += soils.share[i] * area * soil.cohesion_pa;
      shear_modulus += soils.share[i] / soft * soil.shear_modulus_m;
      // Bekker's work of pressing the rut, per metre, less what earlier wheels have done (soil.h).
      resistance_n += soils.share[i] *
                      compaction_resistance_n(soil, laws.rut_m, footing.pressed_ahead_m, p.width_m);
    }
    if (slope * load + cohesion < laws.friction * load) {
      laws.friction = slope;
      laws.cohesion_n = cohesion;
    }
    const double shear_limit = std::max(laws.limit_n(load), 1e-3);
    // Secant of Janosi's curve at the last step's slip, in a row with the tyre's own slip.
    const double slip = std::max(last_slip_, 1e-6);
    const double yielding =
        soft * slip / (shear_limit * std::max(shear_share(shear_modulus, slip, length), 1e-12));
    slip_stiffness = 1.0 / (1.0 / slip_stiffness + yielding);
    cornering_stiffness = 1.0 / (1.0 / cornering_stiffness + yielding);
    // Janosi's initial slope, limit / K, in a row with the bristles.
    const double shearing = soft * shear_modulus / shear_limit;
    laws.along.stiffness = 1.0 / (1.0 / laws.along.stiffness + shearing);
    laws.across.stiffness = 1.0 / (1.0 / laws.across.stiffness + shearing);
    if (footing.reach_m > 0.0) {
      // Onto harder ground and out of its rut the wheel climbs: N times the rise per way of what
      // carries this load.
      const double here = under.at(load).sinkage_m;
      const double next = curves(footing.next, pressure_pa).at(load).sinkage_m;
      resistance_n += load * std::max(0.0, here - next) / WheelFooting::kNext_m;
      if (footing.pressed_ahead_m < soils.pressed_m) {
        SoftSoils ahead = soils;
        ahead.pressed_m = footing.pressed_ahead_m;
        const double there = curves(ahead, pressure_pa).at(load).sinkage_m;
        resistance_n += load * std::max(0.0, here - there) / footing.reach_m;
      }
    }
  }
  // t = l / 6 of the chord 2 sqrt(d (2 R - d)).
  const double flattened = std::clamp(deflection, 0.0, p.unloaded_radius_m);
  laws.trail_m =
      (1.0 - last_grip_) / 3.0 * std::sqrt(flattened * (2.0 * p.unloaded_radius_m - flattened));
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

  // Rolling resistance of the tyre's hysteresis, a moment f R N, f = f0 (1 - share + share p0 / p).
  const double coefficient =
      p.rolling_resistance * (1.0 - p.rolling_pressure_share +
                              p.rolling_pressure_share * p.reference_pressure_pa / pressure);
  laws.rolling_arm_m = coefficient * laws.rolling_radius_m;
  const double rolling_limit = laws.rolling_arm_m * load;
  const double radius2 = laws.rolling_radius_m * laws.rolling_radius_m;
  laws.turning.stiffness = std::max(rolling_limit, 1e-6 * p.reference_load_n) / kRollingWind_rad;
  laws.turning.damping = damping(laws.turning.stiffness, carried_mass_kg_ * radius2);
  laws.rolling = turning_.force(laws.turning, h, 0.0);
  laws.turning_yields = yields(laws.rolling, last_rate_radps_, rolling_limit);

  // What the soil takes: a force on the wheel's centre along the ground, not on its spin.
  laws.ploughing_n = resistance_n;
  if (resistance_n > 0.0) {
    laws.pushing.stiffness = resistance_n / kPloughingWind_m;
    laws.pushing.damping = damping(laws.pushing.stiffness, carried_mass_kg_);
    laws.ploughing = ploughing_.force(laws.pushing, h, 0.0);
    laws.pushing_yields = yields(laws.ploughing, last_way_mps_, resistance_n);
  } else {
    ploughing_.reset();
  }
  return laws;
}

void Tyre::settle(double h, const TyreLaws& laws, const TyreResult& result) {
  if (!laws.touching) {
    return;
  }
  along_.slide(laws.along, h, laws.rolling_speed_mps, result.longitudinal_slide_mps);
  across_.slide(laws.across, h, laws.rolling_speed_mps, result.lateral_slide_mps);
  if (result.slipping) {
    yield_as_bent(along_, laws.along, across_, laws.across,
                  std::hypot(result.longitudinal_n, result.lateral_n));
  }
  if (result.rolling_limited || laws.turning_yields) {
    turning_.slide_within(laws.turning, h, 0.0, result.wheel_rate_radps,
                          std::abs(result.rolling_nm));
  } else {
    turning_.slide(laws.turning, h, 0.0, result.wheel_rate_radps);
  }
  last_rate_radps_ = result.wheel_rate_radps;
  if (laws.ploughing_n > 0.0) {
    if (result.ploughing_limited || laws.pushing_yields) {
      ploughing_.slide_within(laws.pushing, h, 0.0, result.way_mps, std::abs(result.ploughing_n));
    } else {
      ploughing_.slide(laws.pushing, h, 0.0, result.way_mps);
    }
  }
  last_way_mps_ = result.way_mps;
  const double limit = laws.limit_n(last_load_n_);
  const double force = std::sqrt(result.longitudinal_n * result.longitudinal_n +
                                 result.lateral_n * result.lateral_n);
  last_grip_ = limit > force ? force / limit : 1.0;
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

double Tyre::contact_length_m(double deflection_m, double sinkage_m) const {
  // Behind the axle half of what the tyre flattens, ahead of it also the arc that goes down into
  // the rut, sqrt(z (2 R - z)).
  const double z = std::clamp(sinkage_m, 0.0, parameters_.unloaded_radius_m);
  return contact_area_m2(deflection_m) / parameters_.width_m +
         std::sqrt(z * (2.0 * parameters_.unloaded_radius_m - z));
}

}  // namespace rigwire::sim
