// A rigid plate that lies on the ground and is pressed into it: a piece of a track, the pad of a
// blade or an outrigger. Valid from standstill to any sliding speed, on hard ground and on soft
// soil.
//
// Forces come as ImplicitForce, limits are tested after the machine's solve, as sim/tyre has it:
//
//     laws = plate.laws(h, contact, soils, passing speed, way passed);
//     solve;  clamp what exceeds laws.limit_n(normal force);  solve again;
//     plate.settle(h, laws, slide along, slide across, normal force);
//
// Vertical: the plate's own spring in a row with Bekker's soil, p = (k_c / b + k_phi) z^n, along
// Wong's reloading line where it was pressed before (sim/ground/soil.h). Never tensile.
//
// Shear (Z. Janosi, B. Hanamoto, 1961): the stress depends on the distance j that this piece of the
// plate has slid since it was laid down: 1 - exp(-j / K) of the strength by friction and cohesion.
// A track's plate is laid down at its leading end and moves backwards: at the distance x from there
// a shoe has been on the ground for x / V, so that j' = u - (V / x) j, whose steady value is the i
// x of Wong's integral over the contact (J. Y. Wong, Theory of Ground Vehicles, 4th edition 2008,
// chapter 4). Below that bound the plate is held by a bristle, five times as stiff as the curve is
// at its beginning: sheared soil is stiff when it is unloaded (an estimate), and a machine on a
// slope does not creep. At the bound the law is the curve's tangent along the shear and the
// bristle's secant across it. Both directions share one j and one bound, which yields the moment
// that resists turning.
//
// Not modelled: sinkage by slip, soil pushed up in front or aside.
#pragma once

#include <array>
#include <optional>

#include "sim/contact/bristle.h"
#include "sim/ground/ground.h"

namespace rigwire::sim {

struct PlateParameters {
  double area_m2 = 0.3;
  double soil_width_m = 0.6;   ///< b of Bekker's pressure: the smaller side of the bearing area.
  double stiffness_npm = 5e6;  ///< Stiffness of the plate itself.
  double damping_nspm = 5e4;   ///< From a quarter of the reference load on.
  double reference_load_n = 1e4;
  double carried_mass_kg = 1e3;  ///< Mass for the damping of the bristles.
  double damping_ratio = 0.5;    ///< Damping ratio of the bristles.
  double grip = 1.0;             ///< Factor on the ground's coefficient.
  double shear_way_m = 0.005;    ///< K on hard ground.
};

/// Force laws of one step. `normal` is linear in the speed of the plate along the ground's normal,
/// away positive; `along` and `across` in the sliding velocity of the plate against the ground.
struct PlateLaws : ShearLimit {
  bool touching = false;
  ImplicitForce normal;
  ImplicitForce along;
  ImplicitForce across;
  double rut_m = 0.0;  ///< How deep the soft part of the ground is pressed.
  double passing_mps = 0.0;
  double shear_way_m = 0.005;  ///< K.
  BristleParameters shear;
};

class GroundPlate {
 public:
  GroundPlate() = default;
  explicit GroundPlate(const PlateParameters& parameters) : parameters_(parameters) {}

  /// `contact`: overlap of the undeformed plate and the untouched ground; empty: in the air, where
  /// what was sheared is forgotten. `passing_mps`: |V| at which the plate is laid down and passed
  /// on, `way_m` how far ago along it. Never allocates.
  [[nodiscard]] PlateLaws laws(double h, const std::optional<WheelContact>& contact,
                               const SoftSoils& soils, double passing_mps, double way_m);
  /// Ends the step with the slides and the normal force found.
  void settle(double h, const PlateLaws& laws, double along_mps, double across_mps,
              double normal_n);

  /// Load of the last step's start, N.
  [[nodiscard]] double load_n() const { return load_n_; }

 private:
  struct Vertical {
    double load_n = 0.0;
    double slope_npm = 0.0;
    double sinkage_m = 0.0;
  };
  [[nodiscard]] Vertical vertical(double overlap_m, const SoftSoils& soils) const;

  PlateParameters parameters_;
  std::array<Bristle, 2> shear_;
  std::array<double, 2> slid_m_{};  ///< j.
  double sheared_m_ = 0.0;          ///< Maximum |j| of the soil below.
  bool yields_ = false;             ///< Bent as far as j lets.
  double load_n_ = 0.0;
};

/// Sinkage of a plate on soft soils under a load, and its slope, m and m/N (ground_plate.h).
struct PlateSinkage {
  double sinkage_m = 0.0;
  double slope_mpn = 0.0;
};
[[nodiscard]] PlateSinkage plate_sinkage(const SoftSoils& soils, double load_n, double area_m2,
                                         double soil_width_m);

}  // namespace rigwire::sim
