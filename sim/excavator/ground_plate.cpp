#include "sim/excavator/ground_plate.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

namespace {

// Share of the reference load from which the damper is whole.
constexpr double kDampedShare = 0.25;
constexpr double kPrecision = 1e-9;
// Steepness of unloading, as a multiple of the curve's initial steepness.
constexpr double kUnloading = 5.0;
constexpr double kLeastShear_n = 1.0;  // Keeps the bristle's stiffness above 0 without load.

}  // namespace

PlateSinkage plate_sinkage(const SoftSoils& soils, double load_n, double area_m2,
                           double soil_width_m) {
  PlateSinkage sum;
  const double pressure = std::max(load_n, 1e-3) / area_m2;
  for (std::size_t i = 0; i < soils.count; ++i) {
    const SoilParameters& soil = *soils.soil[i];
    // Bekker: p = (k_c / b + k_phi) z^n.
    const double modulus = soil.cohesion_modulus / soil_width_m + soil.friction_modulus;
    const double virgin = std::pow(pressure / modulus, 1.0 / soil.exponent);
    double sinkage = virgin;
    double slope = virgin / (soil.exponent * pressure * area_m2);
    const double pressed = soils.pressed_m;
    if (pressed > virgin) {
      // Wong's reloading line from where the ground was pressed to, never less steep than the
      // virgin curve there.
      const double unloaded_pa = modulus * std::pow(pressed, soil.exponent);
      const double steepness = std::max(soil.reload_modulus + soil.reload_growth * pressed,
                                        soil.exponent * unloaded_pa / pressed);
      const double reloaded = pressed - (unloaded_pa - pressure) / steepness;
      sinkage = std::max(virgin, reloaded);
      slope = reloaded > virgin ? 1.0 / (steepness * area_m2) : slope;
    }
    sum.sinkage_m += soils.share[i] * sinkage;
    sum.slope_mpn += soils.share[i] * slope;
  }
  return sum;
}

GroundPlate::Vertical GroundPlate::vertical(double overlap_m, const SoftSoils& soils) const {
  const PlateParameters& p = parameters_;
  if (!(overlap_m > 0.0) || soils.count == 0) {
    return {p.stiffness_npm * std::max(0.0, overlap_m), p.stiffness_npm, 0.0};
  }
  // Two springs in a row: the load at which load / k + sinkage(load) is the overlap. Both grow with
  // it; Newton's rule within a bracket.
  double low = 0.0;
  double high = p.stiffness_npm * overlap_m;
  double load = load_n_ > 0.0 && load_n_ < high ? load_n_ : 0.5 * high;
  PlateSinkage ground;
  for (int i = 0; i < 80; ++i) {
    ground = plate_sinkage(soils, load, p.area_m2, p.soil_width_m);
    const double excess = load / p.stiffness_npm + ground.sinkage_m - overlap_m;
    (excess > 0.0 ? high : low) = load;
    const double change = excess / (1.0 / p.stiffness_npm + ground.slope_mpn);
    if (std::abs(change) < kPrecision * load || high - low < kPrecision * load) {
      break;
    }
    const double next = load - change;
    load = next > low && next < high ? next : (low > 0.0 ? 0.5 * (low + high) : 0.05 * high);
  }
  return {load, p.stiffness_npm / (1.0 + p.stiffness_npm * ground.slope_mpn), ground.sinkage_m};
}

PlateLaws GroundPlate::laws(double h, const std::optional<WheelContact>& contact,
                            const SoftSoils& soils, double passing_mps, double way_m) {
  PlateLaws laws;
  if (!contact || !(contact->depth_m > 0.0)) {
    shear_[0].reset();
    shear_[1].reset();
    slid_m_ = {};
    sheared_m_ = 0.0;
    yields_ = false;
    load_n_ = 0.0;
    return laws;
  }
  const PlateParameters& p = parameters_;
  const Vertical at = vertical(contact->depth_m, soils);
  load_n_ = at.load_n;
  laws.touching = true;
  // N = spring + c d', linear in the speed away from the ground at the step's end.
  const double damped = std::min(1.0, at.load_n / (kDampedShare * p.reference_load_n));
  laws.normal = {at.load_n, at.slope_npm * h + damped * p.damping_nspm};

  // What shear the contact bears: Mohr-Coulomb's A c + W tan(phi) of each soil, friction on what is
  // hard; nowhere more than the surface's own friction.
  const double friction = p.grip * contact->ground.friction;
  double slope = friction;
  double cohesion = 0.0;
  double shear_way = p.shear_way_m;
  if (soils.count > 0) {
    const double soft = soils.whole_share();
    laws.rut_m = at.sinkage_m / soft;
    slope *= 1.0 - soft;
    shear_way *= 1.0 - soft;
    for (std::size_t i = 0; i < soils.count; ++i) {
      const SoilParameters& soil = *soils.soil[i];
      slope += soils.share[i] * std::tan(soil.internal_friction_rad);
      cohesion += soils.share[i] * p.area_m2 * soil.cohesion_pa;
      shear_way += soils.share[i] * soil.shear_modulus_m;
    }
    if (slope * at.load_n + cohesion > friction * at.load_n) {
      slope = friction;
      cohesion = 0.0;
    }
  }
  laws.friction = slope;
  laws.cohesion_n = cohesion;
  laws.shear_way_m = shear_way;
  laws.passing_mps = std::abs(passing_mps);
  const double limit = std::max(kLeastShear_n, laws.limit_n(at.load_n));
  laws.shear.stiffness = kUnloading * limit / shear_way;
  laws.shear.damping = 2.0 * p.damping_ratio * std::sqrt(laws.shear.stiffness * p.carried_mass_kg);
  laws.shear.relaxation_length = way_m;
  laws.along = shear_[0].force(laws.shear, h, laws.passing_mps);
  laws.across = shear_[1].force(laws.shear, h, laws.passing_mps);
  const double bent = std::hypot(shear_[0].deflection(), shear_[1].deflection());
  if (yields_ && bent > 0.0) {
    // Janosi and Hanamoto at the step's end, limit (1 - exp(-j / K)), linear in the slide: what is
    // passed on first, then the tangent along the shear, the secant across it.
    const double kept = 1.0 / (1.0 + h * laws.passing_mps / way_m);
    const double left = std::exp(-kept * sheared_m_ / shear_way);
    const double force = limit * (1.0 - left);
    const double tangent = limit / shear_way * left;
    const double secant = std::min(force / bent, laws.shear.stiffness);
    const double x = shear_[0].deflection() / bent;
    const double y = shear_[1].deflection() / bent;
    laws.along = {-force * x, h * kept * (tangent * x * x + secant * y * y)};
    laws.across = {-force * y, h * kept * (tangent * y * y + secant * x * x)};
  }
  return laws;
}

void GroundPlate::settle(double h, const PlateLaws& laws, double along_mps, double across_mps,
                         double normal_n) {
  if (!laws.touching) {
    return;
  }
  // j' = u - (V / x) j, and the bristles no farther than j lets.
  const double kept = 1.0 / (1.0 + h * laws.passing_mps / laws.shear.relaxation_length);
  slid_m_ = {kept * (slid_m_[0] + h * along_mps), kept * (slid_m_[1] + h * across_mps)};
  sheared_m_ = std::max(kept * sheared_m_, std::hypot(slid_m_[0], slid_m_[1]));
  shear_[0].slide(laws.shear, h, laws.passing_mps, along_mps);
  shear_[1].slide(laws.shear, h, laws.passing_mps, across_mps);
  const double bound =
      std::max(kLeastShear_n, laws.limit_n(normal_n)) * -std::expm1(-sheared_m_ / laws.shear_way_m);
  const double force =
      laws.shear.stiffness * std::hypot(shear_[0].deflection(), shear_[1].deflection());
  yields_ = force > bound;
  yield_as_bent(shear_, laws.shear, bound);
}

}  // namespace rigwire::sim
