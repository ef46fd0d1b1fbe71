#include "sim/ground/soil.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kLeastExponent = 0.3;
constexpr double kGreatestExponent = 2.0;

double clipped_exponent(const SoilParameters& soil) {
  return std::clamp(soil.exponent, kLeastExponent, kGreatestExponent);
}

}  // namespace

void validate(const SoilParameters& soil) {
  const auto require = [&soil](bool fine, const char* member, double found, const char* allowed) {
    if (!std::isfinite(found) || !fine) {
      std::ostringstream text;
      text.precision(9);
      text << "soil '" << soil.name << "': " << member << " is " << found
           << ", allowed: " << allowed;
      throw std::invalid_argument(text.str());
    }
  };
  constexpr double kRightAngle = std::numbers::pi / 2.0;
  require(soil.friction >= 0.0 && soil.friction <= 2.0, "friction", soil.friction, "0 .. 2");
  require(soil.cohesion_modulus >= 0.0, "cohesion_modulus", soil.cohesion_modulus, "0 or more");
  require(soil.friction_modulus > 0.0, "friction_modulus", soil.friction_modulus, "greater than 0");
  require(soil.exponent >= kLeastExponent && soil.exponent <= kGreatestExponent, "exponent",
          soil.exponent, "0.3 .. 2");
  require(soil.cohesion_pa >= 0.0, "cohesion_pa", soil.cohesion_pa, "0 or more");
  require(soil.internal_friction_rad >= 0.0 && soil.internal_friction_rad < kRightAngle,
          "internal_friction_rad", soil.internal_friction_rad, "0 .. pi/2");
  require(soil.shear_modulus_m > 0.0, "shear_modulus_m", soil.shear_modulus_m, "greater than 0");
  require(soil.density_kgpm3 > 0.0, "density_kgpm3", soil.density_kgpm3, "greater than 0");
  require(soil.repose_rad > 0.0 && soil.repose_rad < kRightAngle, "repose_rad", soil.repose_rad,
          "between 0 and pi/2");
  require(soil.adhesion_pa >= 0.0, "adhesion_pa", soil.adhesion_pa, "0 or more");
  require(soil.tool_friction_rad >= 0.0 && soil.tool_friction_rad < kRightAngle,
          "tool_friction_rad", soil.tool_friction_rad, "0 .. pi/2");
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

double shear_share(const SoilParameters& soil, double slip, double contact_length_m) {
  // Janosi and Hanamoto along the contact: mean of 1 - exp(-j / K), j = |s| x from 0 to |s| l.
  const double x = std::abs(slip) * contact_length_m / soil.shear_modulus_m;
  // 1 - (1 - exp(-x)) / x loses digits near 0: there the series x/2 - x^2/6 + x^3/24 - x^4/120.
  if (x < 0.01) {
    return x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x / 720.0))));
  }
  return 1.0 + std::expm1(-x) / x;
}

}  // namespace rigwire::sim
