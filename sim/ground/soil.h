// What the ground is made of, and what it does to a wheel: pressure-sinkage and shear-displacement
// in closed form.
//
// Loaded a second time, soil that was pressed to z_u answers along a steeper line, p = p_u - k_u
// (z_u
// - z) with k_u = k_0 + A_u z_u, and along the virgin curve beyond (Wong; the default A_u is of the
// order of his dry sand's). Never less steep than the virgin curve.
//
// Sources: M. G. Bekker, Introduction to Terrain-Vehicle Systems, 1969 (pressure-sinkage, rigid
// wheel); Z. Janosi, B. Hanamoto, 1961 (shear-displacement); J. Y. Wong, Theory of Ground
// Vehicles, 4th edition 2008, chapter 2 (repetitive loading). The equations and their limits are in
// the functions' words.
#pragma once

#include <string>

#include "fields/rules.h"

namespace rigwire::sim {

struct SoilParameters {
  std::string name = "hard";
  /// Peak coefficient of friction of a rubber tyre on it; on soft soil cohesion and internal
  /// friction may carry less, and the minimum counts.
  double friction = 0.8;
  /// Hard ground does not sink; the members below are not used then.
  bool soft = false;
  double cohesion_modulus = 0.0;          ///< k_c, N / m^(n+1).
  double friction_modulus = 2.0e6;        ///< k_phi, N / m^(n+2).
  double exponent = 1.1;                  ///< n, 0.3 .. 2.
  double cohesion_pa = 0.0;               ///< c.
  double internal_friction_rad = 0.5236;  ///< phi.
  double shear_modulus_m = 0.01;          ///< K of Janosi and Hanamoto.
  double reload_modulus = 0.0;            ///< k_0 of Wong's reloading, Pa / m.
  double reload_growth = 5.0e8;           ///< A_u of Wong's reloading, Pa / m^2.
  double density_kgpm3 = 1600.0;          ///< Density in place; for digging.
  double repose_rad = 0.6458;             ///< Angle of repose: steepest stable slope, 37 degrees.
  double adhesion_pa = 0.0;               ///< Adhesion to steel; for digging.
  double tool_friction_rad = 0.35;        ///< Friction angle against steel; for digging.
  double reflectance = 0.0;  ///< Diffuse, at 905 nm; 0: that of the terrain's material.

  friend bool operator==(const SoilParameters&, const SoilParameters&) = default;
};

void visit(fields::Visitor& v, SoilParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const SoilParameters& soil);

/// Static sinkage of a rigid wheel, z = [3 W / ((3 - n) (k_c + b k_phi) sqrt(D))]^(2 / (2 n + 1)),
/// 0 on hard ground or without load. Grows with the load for every n.
[[nodiscard]] double wheel_sinkage_m(const SoilParameters& soil, double load_n, double width_m,
                                     double diameter_m);

/// The inverse: load at which a wheel sinks that deep; not for hard ground.
[[nodiscard]] double wheel_load_n(const SoilParameters& soil, double sinkage_m, double width_m,
                                  double diameter_m);

/// Static sinkage under a plate with that mean pressure, z = [p / (k_c / b + k_phi)]^(1/n): what a
/// tyre softer than the ground sinks, whatever its load.
[[nodiscard]] double plate_sinkage_m(const SoilParameters& soil, double pressure_pa,
                                     double width_m);

/// Resistance of compacting a rut from one depth to another: the difference of two
/// compaction_resistance_n(), 0 where the first is the deeper one.
[[nodiscard]] double compaction_resistance_n(const SoilParameters& soil, double sinkage_m,
                                             double pressed_m, double width_m);

/// Resistance of compacting a rut that deep, R_c = b (k_c / b + k_phi) z^(n+1) / (n+1).
[[nodiscard]] double compaction_resistance_n(const SoilParameters& soil, double sinkage_m,
                                             double width_m);

/// Rigid wheel or flattened tyre on one soil: sinkage over load, along the virgin curve or, where
/// the ground was pressed before, along the reloading line up to it.
class SinkageCurve {
 public:
  /// Hard: never sinks.
  SinkageCurve() = default;
  /// A tyre sinks no deeper than a plate with its `ground_pressure_pa`. `pressed_m`: maximum depth
  /// before, 0 for virgin ground.
  SinkageCurve(const SoilParameters& soil, double width_m, double diameter_m,
               double ground_pressure_pa, double pressed_m);

  struct Point {
    double sinkage_m = 0.0;
    double slope_mpn = 0.0;  ///< d sinkage / d load.
  };
  /// Returns the point at load >= 0.
  [[nodiscard]] Point at(double load_n) const;

 private:
  double load_at_1m_n_ = 1.0;
  double inverse_exponent_ = 1.0;  ///< Exponent of the sinkage over the load: 1 / (n + 1/2).
  double flat_m_ = 0.0;
  double pressed_m_ = 0.0;
  double pressed_load_n_ = 0.0;  ///< Load at which the virgin curve reaches pressed_m.
  double reload_npm_ = 0.0;      ///< Stiffness of the reloading line.
};

/// Maximum shear force under a contact: min(A c + W tan phi, friction W) on soft soil, friction W
/// on hard ground.
[[nodiscard]] double shear_limit_n(const SoilParameters& soil, double load_n, double area_m2);

/// Share 0 .. 1 of the shear limit at slip s over a contact of length l (Janosi and Hanamoto):
/// 1 - K / (|s| l) (1 - exp(-|s| l / K)); the series |s| l / (2 K) near s l = 0.
[[nodiscard]] double shear_share(double shear_modulus_m, double slip, double contact_length_m);
[[nodiscard]] inline double shear_share(const SoilParameters& soil, double slip,
                                        double contact_length_m) {
  return shear_share(soil.shear_modulus_m, slip, contact_length_m);
}

}  // namespace rigwire::sim
