// Pull of one driven wheel on soft ground over its slip: the tyre's own balance (sim/tyre/tyre.h),
// Bekker's and Wong's in closed form, and what is published of tractors' tyres in the field.
//
// Soils: J. Y. Wong, Theory of Ground Vehicles, 4th edition 2008, table 2.3, his own measurements.
// Their K is 20 mm, an estimate: the table has none for them.
//
// Field: W. W. Brixius, Traction prediction equations for bias ply tires, ASAE paper 87-1622, 1987,
// as in ASABE D497, a fit to field tests of tractors' tyres; quoted from memory and not checked
// against the paper, but with the same constants as two open programs of others. Its only soil
// parameter is the cone index, which Wong's table lacks: it is computed from his moduli, as the
// mean of Bekker's pressure down to 0.15 m, with the radius of the ASAE cone's base as his b (for a
// round plate, the radius). That applies moduli of plates 50 to 100 mm wide to one of 10 mm: the
// cone index is the most uncertain of these figures.
//
// Test bed: the only available published pull over slip with its own soil's moduli. L. Ding and
// others, Experimental study and analysis on driving wheels' performance for planetary exploration
// rovers moving in deformable soil, J. Terramechanics 48 (2011) 27: rigid wheels of 157 mm radius
// with 80 N on a dry simulant, smooth, and with 30 lugs of 10 mm. Soil: their table 2, K the middle
// of 9.7 to 13.1 mm. Points: read off their figure 9 by others (the table single_wheel_experiments
// of the open project roverdevkit, which calls them approximate), to half a newton.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/tyre/tyre.h"

namespace rigwire::bench {

/// A wheel that is driven over untouched, endless ground. Load: the tyre's reference load.
struct DrawbarCase {
  sim::SoilParameters soil;
  sim::TyreParameters tyre;  ///< 395/85 R20.
  double pressure_pa = 1.2e5;
  double load_n = 2.2e4;
};

/// Wong's three loams, each at the pressures of field and road.
inline std::array<DrawbarCase, 6> drawbar_cases() {
  struct Row {
    const char* name;
    double exponent, cohesion_modulus, friction_modulus, cohesion_pa, friction_deg;
  };
  constexpr std::array<Row, 3> kWong{
      {{"Upland sandy loam", 1.10, 74.6e3, 2080e3, 3.3e3, 33.7},
       {"North Gower clayey loam", 0.73, 41.6e3, 2471e3, 6.1e3, 26.6},
       {"Grenville loam", 1.01, 0.06e3, 5880e3, 3.1e3, 29.8}}};
  std::array<DrawbarCase, 6> cases;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Row& row = kWong[i / 2];
    sim::SoilParameters& soil = cases[i].soil;
    soil.name = row.name;
    soil.soft = true;
    soil.exponent = row.exponent;
    soil.cohesion_modulus = row.cohesion_modulus;
    soil.friction_modulus = row.friction_modulus;
    soil.cohesion_pa = row.cohesion_pa;
    soil.internal_friction_rad = row.friction_deg * std::numbers::pi / 180.0;
    soil.shear_modulus_m = 0.02;
    cases[i].pressure_pa = i % 2 == 0 ? 1.2e5 : 4.5e5;
  }
  return cases;
}

/// A wheel in a test bed, and what was measured of it.
struct MeasuredWheel {
  struct Point {
    double slip, pull_n, sinkage_m;
  };
  const char* name;
  DrawbarCase wheel;
  std::array<Point, 6> points;
};

inline std::array<MeasuredWheel, 2> measured_wheels() {
  DrawbarCase one;
  one.soil.name = "planetary simulant";
  one.soil.soft = true;
  one.soil.exponent = 1.10;
  one.soil.cohesion_modulus = 15.6e3;
  one.soil.friction_modulus = 2407.4e3;
  one.soil.cohesion_pa = 250.0;
  one.soil.internal_friction_rad = 31.9 * std::numbers::pi / 180.0;
  one.soil.shear_modulus_m = 0.0114;
  one.load_n = 80.0;
  one.pressure_pa = 1e5;
  // Rigid: pressed in by a hundredth of a millimetre, without slip of its own.
  sim::TyreParameters& tyre = one.tyre;
  tyre.unloaded_radius_m = 0.15735;
  tyre.width_m = 0.165;
  tyre.rim_radius_m = 0.1;
  tyre.carcass_stiffness_npm = 8e6;
  tyre.stiffness_per_pressure_m = 1e-3;
  tyre.reference_load_n = one.load_n;
  tyre.slip_stiffness_n = 1e5;
  tyre.longitudinal_stiffness_npm = 1e6;
  tyre.rolling_resistance = 0.0;
  return {{{"smooth",
            one,
            {{{0.0, -6.5, 0.005},
              {0.1, 11.0, 0.0055},
              {0.2, 14.5, 0.0075},
              {0.3, 15.0, 0.010},
              {0.4, 15.0, 0.0125},
              {0.6, 15.0, 0.0175}}}},
           {"30 lugs of 10 mm",
            one,
            {{{0.0, -6.5, 0.0045},
              {0.1, 14.0, 0.005},
              {0.2, 20.0, 0.0075},
              {0.3, 22.0, 0.0105},
              {0.4, 23.0, 0.014},
              {0.6, 24.5, 0.027}}}}}};
}

/// Shares of the load. Slip is 1 - V / (w R).
struct Drawbar {
  double thrust = 0.0;
  double resistance = 0.0;
  double sinkage_m = 0.0;

  [[nodiscard]] double pull() const { return thrust - resistance; }
};

/// The code's own: the tyre in steps of 1 ms, its axle held at the height at which it carries the
/// load and pulled along so that the slip is kept, until bristles and soil are steady.
inline Drawbar measured_drawbar(const DrawbarCase& one, double slip) {
  constexpr double kStep_s = 1e-3;
  constexpr double kRolling_mps = 1.5;
  sim::Tyre tyre(one.tyre, one.load_n / 9.80665);
  sim::WheelContact contact;
  contact.ground.friction = one.soil.friction;
  contact.depth_m = tyre.overlap_m(one.load_n, &one.soil, one.pressure_pa);
  Drawbar found;
  for (int i = 0; i < 4000; ++i) {
    const sim::TyreLaws laws = tyre.laws(kStep_s, contact, one.soil, one.pressure_pa, kRolling_mps);
    sim::TyreResult result;
    result.longitudinal_slide_mps = slip * kRolling_mps;
    result.way_mps = kRolling_mps - result.longitudinal_slide_mps;
    result.wheel_rate_radps = kRolling_mps / laws.rolling_radius_m;
    const double most = laws.limit_n(one.load_n);
    const double along = -laws.longitudinal.at(result.longitudinal_slide_mps);
    result.slipping = along > most;
    result.longitudinal_n = -std::min(along, most);
    const double pressing = -laws.ploughing.at(result.way_mps);
    result.ploughing_limited = pressing > laws.ploughing_n;
    result.ploughing_n = -std::min(pressing, laws.ploughing_n);
    result.rolling_nm = laws.rolling.at(result.wheel_rate_radps);
    tyre.settle(kStep_s, laws, result);
    found = {-result.longitudinal_n / one.load_n, -result.ploughing_n / one.load_n, laws.sinkage_m};
  }
  return found;
}

/// Wong's elastic wheel (4th edition, 2.5.2): on its flat, load over ground pressure long, as deep
/// as a plate with that pressure; a rigid one where that is less deep. The tyre itself has no slip.
inline Drawbar closed_drawbar(const DrawbarCase& one, double slip) {
  const sim::TyreParameters& tyre = one.tyre;
  const sim::SoilParameters& soil = one.soil;
  const double width = tyre.width_m;
  const double diameter = 2.0 * tyre.unloaded_radius_m;
  const double ground_pa =
      one.pressure_pa + tyre.carcass_stiffness_npm / tyre.stiffness_per_pressure_m;
  const double modulus = soil.cohesion_modulus / width + soil.friction_modulus;
  const double n = soil.exponent;
  const double flat = std::pow(ground_pa / modulus, 1.0 / n);
  const double rigid =
      std::pow(3.0 * one.load_n / ((3.0 - n) * width * modulus * std::sqrt(diameter)),
               2.0 / (2.0 * n + 1.0));
  const double sinkage = std::min(flat, rigid);
  const double length =
      flat < rigid ? one.load_n / (width * ground_pa) : std::sqrt(sinkage * (diameter - sinkage));
  const double x = slip * length / soil.shear_modulus_m;
  const double strength =
      width * length * soil.cohesion_pa / one.load_n + std::tan(soil.internal_friction_rad);
  return {strength * (x > 0.0 ? 1.0 - (1.0 - std::exp(-x)) / x : 0.0),
          width * modulus * std::pow(sinkage, n + 1.0) / ((n + 1.0) * one.load_n), sinkage};
}

/// From Bekker's moduli, see above.
inline double cone_index_pa(const sim::SoilParameters& soil) {
  constexpr double kBase_m = 0.5 * 0.02027;
  constexpr double kWay_m = 0.15;
  return (soil.cohesion_modulus / kBase_m + soil.friction_modulus) *
         std::pow(kWay_m, soil.exponent) / (soil.exponent + 1.0);
}

/// Bn = CI b d / W (1 + 5 deflection / section height) / (1 + 3 b / d).
inline double mobility_number(const DrawbarCase& one) {
  const sim::TyreParameters& tyre = one.tyre;
  const double diameter = 2.0 * tyre.unloaded_radius_m;
  const double deflection =
      one.load_n / (tyre.carcass_stiffness_npm + tyre.stiffness_per_pressure_m * one.pressure_pa);
  return cone_index_pa(one.soil) * tyre.width_m * diameter / one.load_n *
         (1.0 + 5.0 * deflection / (tyre.unloaded_radius_m - tyre.rim_radius_m)) /
         (1.0 + 3.0 * tyre.width_m / diameter);
}

/// Brixius: gross traction 0.88 (1 - exp(-0.1 Bn)) (1 - exp(-7.5 s)) + 0.04, resistance 1 / Bn +
/// 0.04 + 0.5 s / sqrt(Bn). No sinkage.
inline Drawbar published_drawbar(double mobility, double slip) {
  return {0.88 * (1.0 - std::exp(-0.1 * mobility)) * (1.0 - std::exp(-7.5 * slip)) + 0.04,
          1.0 / mobility + 0.04 + 0.5 * slip / std::sqrt(mobility), 0.0};
}

}  // namespace rigwire::bench
