#include "sim/ground/soil.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kLeastExponent = 0.3;
constexpr double kGreatestExponent = 2.0;
constexpr double kSteepest_deg = 89.0;  // The tangent of angles has its pole at 90 degrees.

double clipped_exponent(const SoilParameters& soil) {
  return std::clamp(soil.exponent, kLeastExponent, kGreatestExponent);
}

}  // namespace

void visit(fields::Visitor& v, SoilParameters& p) {
  v.text("name", p.name, "Name by which regions call the soil.");
  v.number("friction", p.friction, plain().between(0, 2),
           "Peak coefficient of friction of rubber on it.");
  v.boolean("soft", p.soft, "Whether wheels sink in; only then the moduli below matter to them.");
  v.number("cohesion_modulus", p.cohesion_modulus, plain().between(0, 1e12),
           "k_c of Bekker's pressure over sinkage, N / m^(n+1).");
  v.number("friction_modulus", p.friction_modulus, plain().between(1e-6, 1e12),
           "k_phi of Bekker's pressure over sinkage, N / m^(n+2).");
  v.number("exponent", p.exponent, plain().between(kLeastExponent, kGreatestExponent),
           "n of Bekker's pressure over sinkage.");
  v.number("cohesion", p.cohesion_pa, in("kPa").between(0, 1e6), "Shear strength without load.");
  v.number("internal_friction", p.internal_friction_rad, in("deg").between(0, kSteepest_deg),
           "Angle by which shear strength grows with load.");
  v.number("shear_modulus", p.shear_modulus_m, in("mm").between(0.001, 1000),
           "K of Janosi and Hanamoto: way to 63 % of the shear strength.");
  v.number("reload_modulus", p.reload_modulus, plain().between(0, 1e12),
           "k_0 of Wong's reloading: pressure per way of ground pressed before, Pa/m.");
  v.number("reload_growth", p.reload_growth, plain().between(0, 1e12),
           "A_u of Wong's reloading: what that grows by per depth to which it was pressed, Pa/m2.");
  v.number("density", p.density_kgpm3, in("kg/m3").between(1, 30'000),
           "Density of the soil as it lies.");
  v.number("repose", p.repose_rad, in("deg").between(0.01, kSteepest_deg),
           "Steepest stable slope of the soil.");
  v.number("adhesion", p.adhesion_pa, in("kPa").between(0, 1e6), "Adhesion of the soil to steel.");
  v.number("tool_friction", p.tool_friction_rad, in("deg").between(0, kSteepest_deg),
           "Angle of friction of the soil against steel.");
  v.number("reflectance", p.reflectance, plain().between(0, 1),
           "Diffuse reflectance at 905 nm; 0 = that of the terrain's material.");
}

void validate(const SoilParameters& soil) {
  fields::check(soil);
}

double wheel_sinkage_m(const SoilParameters& soil, double load_n, double width_m,
                       double diameter_m) {
  if (!soil.soft || !(load_n > 0.0)) {
    return 0.0;
  }
  // Bekker's rigid wheel solved for z: (W / W at 1 m)^(2 / (2 n + 1)).
  return std::pow(load_n / wheel_load_n(soil, 1.0, width_m, diameter_m),
                  1.0 / (clipped_exponent(soil) + 0.5));
}

double wheel_load_n(const SoilParameters& soil, double sinkage_m, double width_m,
                    double diameter_m) {
  const double n = clipped_exponent(soil);
  // Bekker's rigid wheel, W = (3 - n) / 3 (k_c + b k_phi) sqrt(D) z^(n + 1/2).
  const double modulus = soil.cohesion_modulus + width_m * soil.friction_modulus;
  return (3.0 - n) / 3.0 * modulus * std::sqrt(diameter_m) *
         std::pow(std::max(0.0, sinkage_m), n + 0.5);
}

double plate_sinkage_m(const SoilParameters& soil, double pressure_pa, double width_m) {
  if (!soil.soft || !(pressure_pa > 0.0)) {
    return 0.0;
  }
  // Bekker: p = (k_c / b + k_phi) z^n.
  const double modulus = soil.cohesion_modulus / width_m + soil.friction_modulus;
  return std::pow(pressure_pa / modulus, 1.0 / clipped_exponent(soil));
}

double compaction_resistance_n(const SoilParameters& soil, double sinkage_m, double width_m) {
  if (!soil.soft || !(sinkage_m > 0.0)) {
    return 0.0;
  }
  const double n = clipped_exponent(soil);
  // Bekker: integral of b (k_c / b + k_phi) z^n over the sinkage.
  const double modulus = soil.cohesion_modulus / width_m + soil.friction_modulus;
  return width_m * modulus * std::pow(sinkage_m, n + 1.0) / (n + 1.0);
}

double compaction_resistance_n(const SoilParameters& soil, double sinkage_m, double pressed_m,
                               double width_m) {
  const double whole = compaction_resistance_n(soil, sinkage_m, width_m);
  return pressed_m > 0.0 ? std::max(0.0, whole - compaction_resistance_n(soil, pressed_m, width_m))
                         : whole;
}

SinkageCurve::SinkageCurve(const SoilParameters& soil, double width_m, double diameter_m,
                           double ground_pressure_pa, double pressed_m)
    : load_at_1m_n_(wheel_load_n(soil, 1.0, width_m, diameter_m)),
      inverse_exponent_(1.0 / (clipped_exponent(soil) + 0.5)),
      flat_m_(plate_sinkage_m(soil, ground_pressure_pa, width_m)),
      pressed_m_(std::max(0.0, pressed_m)) {
  if (pressed_m_ > 0.0) {
    pressed_load_n_ = wheel_load_n(soil, pressed_m_, width_m, diameter_m);
    // k_u = k_0 + A_u z_u on the contact of a wheel at that depth, b sqrt(D z); at least the virgin
    // curve's slope W (n + 1/2) / z.
    const double area = width_m * std::sqrt(diameter_m * pressed_m_);
    reload_npm_ = std::max(area * (soil.reload_modulus + soil.reload_growth * pressed_m_),
                           pressed_load_n_ / (inverse_exponent_ * pressed_m_));
  }
}

SinkageCurve::Point SinkageCurve::at(double load_n) const {
  Point virgin;
  if (load_n > 0.0) {
    virgin.sinkage_m = std::pow(load_n / load_at_1m_n_, inverse_exponent_);
    virgin.slope_mpn = virgin.sinkage_m * inverse_exponent_ / load_n;
    if (virgin.sinkage_m > flat_m_) {
      virgin = {flat_m_, 0.0};
    }
  }
  if (virgin.sinkage_m >= pressed_m_) {
    return virgin;
  }
  // Below the load that pressed it: up the reloading line. A flat tyre's load spreads: no deeper.
  const double missing = pressed_load_n_ - load_n;
  if (missing <= 0.0) {
    return {pressed_m_, 0.0};
  }
  const double risen = pressed_m_ - missing / reload_npm_;
  return risen > 0.0 ? Point{risen, 1.0 / reload_npm_} : Point{0.0, 0.0};
}

double shear_limit_n(const SoilParameters& soil, double load_n, double area_m2) {
  if (!(load_n > 0.0)) {
    return 0.0;
  }
  const double rubber = soil.friction * load_n;
  if (!soil.soft) {
    return rubber;
  }
  // Mohr-Coulomb under the contact, A c + W tan(phi), or the surface's friction.
  return std::min(rubber,
                  area_m2 * soil.cohesion_pa + load_n * std::tan(soil.internal_friction_rad));
}

double shear_share(double shear_modulus_m, double slip, double contact_length_m) {
  // Janosi and Hanamoto along the contact: mean of 1 - exp(-j / K), j = |s| x from 0 to |s| l.
  const double x = std::abs(slip) * contact_length_m / shear_modulus_m;
  // 1 - (1 - exp(-x)) / x loses digits near 0: there the series x/2 - x^2/6 + x^3/24 - x^4/120.
  if (x < 0.01) {
    return x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x / 720.0))));
  }
  return 1.0 + std::expm1(-x) / x;
}

}  // namespace rigwire::sim
