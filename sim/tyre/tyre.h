// One pneumatic tyre (or one strip of a steel drum): vertical spring by pressure, bristles along
// and across, rolling resistance; good from standstill to top speed, on hard ground and on soft
// soil.
//
// Forces come as ImplicitForce (sim/contact/bristle.h), linear in the velocities at the end of the
// step, for the machine's own solve; limits are tested after the solve (clamp last). Order of calls
// per step:
//
//     laws = tyre.laws(h, contact, footing, pressure, rolling speed);
//     solve;  clamp what exceeds laws.limit_n(normal force);  solve again;
//     tyre.settle(h, laws, result);
//
// Vertical: F = max(0, k(p) d + bottoming + c d'), never tensile; k(p) = carcass + p times
// stiffness_per_pressure; the damper fades below a quarter of the reference load. Tangential:
// bristles whose steady-state slip stiffness is slip_stiffness_n times the share of the reference
// load; on soft soil the secant of Janosi's curve, with the limit of soil.h. Rolling resistance: a
// moment against the spin, coefficient times load times radius, grown as the pressure falls; a
// bristle too, so that it holds at rest.
//
// Load: the slip stiffness goes with it; the cornering stiffness as sin(2 atan(N / N_peak)), so
// that a pair of wheels corners the worse the more load has gone from one to the other (H. B.
// Pacejka, Tire and Vehicle Dynamics, 3rd edition 2012, equation 4.E25). The lateral force acts
// behind the wheel's centre by the trail of the brush model, a sixth of the contact's chord
// (Pacejka, chapter 3), less in proportion to the grip that is used: the aligning moment.
//
// Soft soil (sim/ground/soil.h): tyre and soil are springs in a row. Bekker's resistance of
// pressing the rut, less what earlier wheels have pressed, and N times the rise where the wheel
// climbs out of softer ground or out of its rut, are one force on the wheel's centre along the
// ground. Soil presses on a rim square to it, through its axle, so that there is no moment: what
// drives the wheel forward has to come from shear, with slip. Going down into softer ground gives
// nothing back, so that no order of soils, loads and ruts gives energy. Not modelled: sinkage by
// slip, soil pushed aside by the flanks, and the rut's walls.
//
// Two radii: the contact is R - d below the wheel's centre, but an inextensible belt puts the arc 2
// R phi on the chord 2 R sin(phi), cos(phi) = 1 - d / R: the freely rolling wheel advances R
// sin(phi) / phi = R - d / 3 per radian (R. Rajamani, Vehicle Dynamics and Control, 2nd edition
// 2012, chapter 4, effective tire radius; the series' next term is d^2 / (45 R)).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "fields/rules.h"
#include "sim/contact/bristle.h"
#include "sim/ground/ground.h"

namespace rigwire::sim {

/// Defaults: 395/85 R20. Estimates, but for the sizes.
struct TyreParameters {
  double unloaded_radius_m = 0.590;
  double width_m = 0.395;
  double rim_radius_m = 0.254;  ///< Radius at which the tyre bottoms: the rim's spring takes over.
  double carcass_stiffness_npm = 3.4e4;     ///< k at no pressure.
  double stiffness_per_pressure_m = 1.555;  ///< dk/dp, N/m per Pa.
  double vertical_damping_nspm = 3.0e3;
  double bottoming_factor = 5.0;    ///< Stiffness on the rim, as a multiple of k(p).
  double reference_load_n = 2.2e4;  ///< Load at which the slip stiffnesses hold.
  double reference_pressure_pa = 4.5e5;
  double slip_stiffness_n = 2.0e5;            ///< dF/dslip at slip 0, reference load.
  double cornering_stiffness_nprad = 1.5e5;   ///< dF/dslip angle, reference load.
  double cornering_peak_load_n = 5.5e4;       ///< Load of the maximum cornering stiffness.
  double longitudinal_stiffness_npm = 6.0e5;  ///< Longitudinal stiffness of the bristles.
  double lateral_stiffness_npm = 3.5e5;       ///< Lateral stiffness of the bristles.
  double damping_ratio = 0.7;         ///< Damping ratio of the bristles with the mass at the wheel.
  double friction_factor = 1.0;       ///< Factor on the ground's coefficient.
  double rolling_resistance = 0.012;  ///< Coefficient at reference pressure, hard ground.
  /// Share of that coefficient that is proportional to 1 / pressure.
  double rolling_pressure_share = 0.5;

  friend bool operator==(const TyreParameters&, const TyreParameters&) = default;
};

void visit(fields::Visitor& v, TyreParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const TyreParameters& parameters);

/// Way per radian of a tyre that rolls freely, pressed in by that much: R - d / 3.
[[nodiscard]] double effective_radius_m(const TyreParameters& parameters, double deflection_m);

/// The laws of one step. Signs: `normal` in the speed of the wheel's centre along the contact's
/// normal, away from the ground positive; `longitudinal` and `lateral` in the sliding velocity of
/// the tyre's contact patch against the ground (forward, left); `rolling` in the wheel's rate, a
/// moment; `ploughing` in the speed of the wheel's centre along the ground, forward.
struct TyreLaws : ShearLimit {
  bool touching = false;
  ImplicitForce normal;
  ImplicitForce longitudinal;
  ImplicitForce lateral;
  ImplicitForce rolling;
  ImplicitForce ploughing;
  double rolling_arm_m = 0.0;    ///< Limit of the rolling moment per normal force.
  double ploughing_n = 0.0;      ///< Limit of `ploughing`; 0: there is none.
  double loaded_radius_m = 0.0;  ///< From the wheel's centre to the contact, R - d.
  /// Way per radian of a freely rolling wheel, R - d / 3; also the lever of the longitudinal force
  /// about the axle, so that the shaft's work equals that of road and slip.
  double rolling_radius_m = 0.0;
  /// Distance of the lateral force behind the wheel's centre while it rolls.
  double trail_m = 0.0;
  double sinkage_m = 0.0;
  double rut_m = 0.0;              ///< Depth to which the soft part of the ground is pressed.
  double pressed_m = 0.0;          ///< Depth to which it was pressed before.
  double rolling_speed_mps = 0.0;  ///< Rolling speed |V| of the bristles.
  BristleParameters along;
  BristleParameters across;
  BristleParameters turning;
  BristleParameters pushing;
  bool turning_yields = false;  ///< The wheel turns: `rolling` is the secant of its limit.
  bool pushing_yields = false;  ///< The wheel moves: `ploughing` is the secant of its limit.
};

/// Result of the machine's solve, for settle().
struct TyreResult {
  double longitudinal_n = 0.0;
  double lateral_n = 0.0;
  double rolling_nm = 0.0;
  double ploughing_n = 0.0;
  double longitudinal_slide_mps = 0.0;
  double lateral_slide_mps = 0.0;
  double wheel_rate_radps = 0.0;
  double way_mps = 0.0;            ///< Speed of the wheel's centre along the ground, forward.
  bool slipping = false;           ///< The tangential force was held at its limit.
  bool rolling_limited = false;    ///< The rolling moment was held at its limit.
  bool ploughing_limited = false;  ///< The soil's resistance was held at its limit.
};

/// The tyre's vertical spring, alone or with soft soil in a row.
struct TyreSpring {
  double force_n = 0.0;
  double slope_npm = 0.0;  ///< dF / d overlap.
  double sinkage_m = 0.0;  ///< The soil's share of the overlap.
};

/// Curves of all soils under a tyre.
struct SoilCurves {
  std::array<SinkageCurve, SoftSoils::kMost> curve;
  std::array<double, SoftSoils::kMost> share{};
  std::size_t count = 0;

  /// Their sinkages by their shares.
  [[nodiscard]] SinkageCurve::Point at(double load_n) const;
};

class Tyre {
 public:
  /// `carried_mass_kg`: what the bristles' damping is tuned for.
  Tyre(const TyreParameters& parameters, double carried_mass_kg);

  /// `contact` empty: in the air; bristles are reset. On soft soil the slip of the last step
  /// chooses the secant. Never allocates.
  [[nodiscard]] TyreLaws laws(double h, const std::optional<WheelContact>& contact,
                              const WheelFooting& footing, double pressure_pa,
                              double rolling_speed_mps);
  void settle(double h, const TyreLaws& laws, const TyreResult& result);

  [[nodiscard]] double stiffness_npm(double pressure_pa) const;
  /// Returns the spring at rest, for that overlap of undeformed tyre and untouched ground. If its
  /// pressure is below the ground's bearing capacity, the tyre flattens: it sinks as a plate with
  /// its pressure.
  [[nodiscard]] TyreSpring spring(double overlap_m, const SoftSoils& soils,
                                  double pressure_pa) const;
  /// Returns the overlap at which it carries that load: the inverse of spring().
  [[nodiscard]] double overlap_m(double load_n, const SoftSoils& soils, double pressure_pa) const;
  /// Returns load over mean ground pressure (inflation and carcass), at most chord times width.
  [[nodiscard]] double contact_area_m2(double deflection_m) const;
  /// Returns the contact length along the heading, in a rut that the wheel presses.
  [[nodiscard]] double contact_length_m(double deflection_m, double sinkage_m) const;
  /// Returns the mean ground pressure of inflation and carcass.
  [[nodiscard]] double ground_pressure_pa(double pressure_pa) const;
  [[nodiscard]] const TyreParameters& parameters() const { return parameters_; }
  [[nodiscard]] double longitudinal_deflection_m() const { return along_.deflection(); }
  [[nodiscard]] double lateral_deflection_m() const { return across_.deflection(); }

 private:
  [[nodiscard]] SoilCurves curves(const SoftSoils& soils, double pressure_pa) const;
  [[nodiscard]] TyreSpring spring(double overlap_m, const SoilCurves& soil, double pressure_pa,
                                  double guess_n) const;

  TyreParameters parameters_;
  double carried_mass_kg_;
  Bristle along_;
  Bristle across_;
  Bristle turning_;
  Bristle ploughing_;
  double last_load_n_ = 0.0;  ///< Where the search for the next one begins.
  double last_grip_ = 0.0;    ///< Share of the limit that was used.
  double last_slip_ = 0.0;
  double last_rate_radps_ = 0.0;
  double last_way_mps_ = 0.0;
};

}  // namespace rigwire::sim
