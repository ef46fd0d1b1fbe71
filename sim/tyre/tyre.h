// One pneumatic tyre (or one strip of a steel drum): vertical spring by pressure, bristles along
// and across, rolling resistance; good from standstill to top speed, on hard ground and on soft
// soil.
//
// Forces come as ImplicitForce (sim/contact/bristle.h), linear in the velocities at the end of the
// step, for the machine's own solve; limits are tested after the solve (clamp last). Order of calls
// per step:
//
//     laws = tyre.laws(h, contact, pressure, rolling speed);
//     solve;  clamp what exceeds laws.limit_n(normal force);  solve again;
//     tyre.settle(h, laws, result);
//
// Vertical: F = max(0, k(p) d + bottoming + c d'), never tensile; k(p) = carcass + p times
// stiffness_per_pressure; the damper fades below a quarter of the reference load. Tangential:
// bristles whose steady-state slip stiffness is slip_stiffness_n times the share of the reference
// load; on soft soil the secant of Janosi's curve, with the limit of soil.h. Rolling resistance: a
// moment against the spin, coefficient times load times radius, grown as the pressure falls, plus
// compaction of the soil; a bristle too, so that it holds at rest.
#pragma once

#include "fields/rules.h"
#include "sim/contact/bristle.h"
#include "sim/ground/ground.h"

namespace rigwire::sim {

/// Defaults: 395/85 R20. Estimates, but for the sizes.
struct TyreParameters {
  double unloaded_radius_m = 0.590;
  double width_m = 0.395;
  double rim_radius_m = 0.254;           ///< Where the tyre bottoms: the rim's spring takes over.
  double carcass_stiffness_npm = 3.4e4;  ///< k at no pressure.
  double stiffness_per_pressure_m = 1.555;  ///< dk/dp, N/m per Pa.
  double vertical_damping_nspm = 3.0e3;
  double bottoming_factor = 5.0;    ///< Stiffness on the rim, times k(p).
  double reference_load_n = 2.2e4;  ///< At which the slip stiffnesses hold.
  double reference_pressure_pa = 4.5e5;
  double slip_stiffness_n = 2.0e5;            ///< dF/dslip at slip 0, reference load.
  double cornering_stiffness_nprad = 1.5e5;   ///< dF/dslip angle, reference load.
  double longitudinal_stiffness_npm = 6.0e5;  ///< Of the bristles, along.
  double lateral_stiffness_npm = 3.5e5;       ///< Of the bristles, across.
  double damping_ratio = 0.7;                 ///< Of the bristles with the mass at the wheel.
  double friction_factor = 1.0;               ///< On the ground's coefficient.
  double rolling_resistance = 0.012;          ///< Coefficient at reference pressure, hard ground.
  double rolling_pressure_share = 0.5;        ///< Of that coefficient, goes with 1 / pressure.

  friend bool operator==(const TyreParameters&, const TyreParameters&) = default;
};

void visit(fields::Visitor& v, TyreParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const TyreParameters& parameters);

/// The laws of one step. Signs: `normal` in the speed of the wheel's centre along the contact's
/// normal, away from the ground positive; `longitudinal` and `lateral` in the sliding velocity of
/// the tyre's contact patch against the ground (forward, left); `rolling` in the wheel's rate, a
/// moment.
struct TyreLaws {
  bool touching = false;
  ImplicitForce normal;
  ImplicitForce longitudinal;
  ImplicitForce lateral;
  ImplicitForce rolling;
  double friction = 0.0;  ///< Limit = friction x normal force + cohesion.
  double cohesion_n = 0.0;
  double rolling_arm_m = 0.0;     ///< Limit of the rolling moment per normal force.
  double rolling_radius_m = 0.0;  ///< Loaded: lever of the tangential forces about the axle.
  double sinkage_m = 0.0;
  double rolling_speed_mps = 0.0;  ///< |V| that the bristles saw.
  BristleParameters along;
  BristleParameters across;
  BristleParameters turning;
  bool turning_yields = false;  ///< The wheel turns: `rolling` is the secant of its limit.

  [[nodiscard]] double limit_n(double normal_n) const {
    return normal_n > 0.0 ? friction * normal_n + cohesion_n : 0.0;
  }
};

/// What the machine's solve found, for settle().
struct TyreResult {
  double longitudinal_n = 0.0;
  double lateral_n = 0.0;
  double rolling_nm = 0.0;
  double longitudinal_slide_mps = 0.0;
  double lateral_slide_mps = 0.0;
  double wheel_rate_radps = 0.0;
  bool slipping = false;         ///< The tangential force was held at its limit.
  bool rolling_limited = false;  ///< The rolling moment was.
};

/// The tyre's vertical spring, alone or with soft soil in a row.
struct TyreSpring {
  double force_n = 0.0;
  double slope_npm = 0.0;  ///< dF / d overlap.
  double sinkage_m = 0.0;  ///< The soil's share of the overlap.
};

class Tyre {
 public:
  /// `carried_mass_kg`: what the bristles' damping is tuned for.
  Tyre(const TyreParameters& parameters, double carried_mass_kg);

  /// `contact` empty: in the air; bristles are reset. `slip` is of the last step and only chooses
  /// the secant on soft soil. Never allocates.
  [[nodiscard]] TyreLaws laws(double h, const std::optional<WheelContact>& contact,
                              const SoilParameters& soil, double pressure_pa,
                              double rolling_speed_mps);
  void settle(double h, const TyreLaws& laws, const TyreResult& result);

  [[nodiscard]] double stiffness_npm(double pressure_pa) const;
  /// At rest, for that overlap of undeformed tyre and untouched ground; `soft` null on hard ground.
  /// A tyre of less pressure than the ground bears flattens: it sinks as a plate with its pressure.
  [[nodiscard]] TyreSpring spring(double overlap_m, const SoilParameters* soft,
                                  double pressure_pa) const;
  /// Load over mean ground pressure (inflation and carcass), at most chord times width.
  [[nodiscard]] double contact_area_m2(double deflection_m) const;
  [[nodiscard]] const TyreParameters& parameters() const { return parameters_; }
  [[nodiscard]] double longitudinal_deflection_m() const { return along_.deflection(); }
  [[nodiscard]] double lateral_deflection_m() const { return across_.deflection(); }

 private:
  TyreParameters parameters_;
  double carried_mass_kg_;
  Bristle along_;
  Bristle across_;
  Bristle turning_;
  double last_slip_ = 0.0;
  double last_rate_radps_ = 0.0;
};

}  // namespace rigwire::sim
