// The machine's own controller of its travel speed, through engine, gear and service brake. It
// executes the "machine selected speed command" of machines without a hydrostatic drive.
//
// The set point passes a ramp. The controller computes a force,
//     F = (m + J / r^2) (ramp's slope + gain (v_ref - v)) + integral + push + pull of the slope,
// with v from the driven wheels' rate. The engine is commanded to provide the driving part as
// torque through the engaged ratio; the service brake provides braking beyond the engine's drag,
// and all of the force while gears change or no gear fits. The slope is the reading of an
// inclination sensor of the frame, behind a lag. At rest with set point 0 the brake is applied and
// stays: there is no rolling on a slope. When starting on one, the brake opens as far as the clutch
// carries. A machine held back by a kerb or a rut is pushed harder and harder, up to the engine's
// limit; the push stays until the speed is reached and is then released, as a driver's foot would.
// To reverse, the machine is brought to rest first, then shifts.
//
// A commanded brake demand overrides the engine and does not wind the integral up. The grip of the
// ground is no limit: a spinning wheel is held at its own speed.
#pragma once

#include "fields/rules.h"
#include "sim/driveline/driveline.h"

namespace rigwire::sim {

/// Estimates; docs/machines/drive-lines.md has the resulting behaviour.
struct TravelControlParameters {
  double acceleration_mps2 = 1.0;  ///< Ramp of the set point, away from 0 ...
  double deceleration_mps2 = 2.0;  ///< ... and towards it.
  double gain_per_s = 1.5;
  double integral_per_s2 = 0.5;
  double inclination_lag_s = 0.3;
  double brake_rate_per_s = 8.0;  ///< Rate limit of the brake's share.
};
void visit(fields::Visitor& v, TravelControlParameters& p);

/// Properties of the machine that the controller uses.
struct TravelMachine {
  double mass_kg = 0.0;
  double radius_m = 0.0;  ///< Radius of the driven wheels.
  double brake_n = 0.0;   ///< At the ground, service brake fully applied.
  double gravity_mps2 = 0.0;
};

class TravelControl {
 public:
  TravelControl(const TravelControlParameters& parameters, const TravelMachine& machine);

  /// Replaces engine, gear and brake of `command`, whose travel_speed_mps is given; `slope` is the
  /// sine of the frame's pitch, nose up positive.
  void step(double h, const Driveline& driveline, double slope, VehicleCommand& command);
  /// Deactivates the controller: no travel speed is commanded.
  void release();

  [[nodiscard]] TravelLimit limit() const { return limit_; }

 private:
  [[nodiscard]] int choose_gear(const Driveline& driveline, const DriveState& state,
                                const VehicleCommand& command, double target_mps);
  /// The push of a machine that is `held_back`, missing so much of its speed.
  void push(double h, bool held_back, double missing_mps);
  /// Whether what is missing is missing for good; and if so tries another gear: a lower one while
  /// the machine gets no faster, a higher one again where the engine turns as fast as it may.
  void judge(double h, const DriveState& state, bool all, bool all_brake, double missing_mps);

  TravelControlParameters parameters_;
  TravelMachine machine_;
  bool active_ = false;
  bool holding_ = false;
  double slope_ = 0.0;
  double reference_mps_ = 0.0;
  double integral_n_ = 0.0;
  double push_n_ = 0.0;  ///< Against what holds it back, in the direction of the gear.
  double held_back_s_ = 0.0;
  double brake_share_ = 0.0;
  double set_point_mps_ = 0.0;
  double last_mps_ = 0.0;
  double acceleration_mps2_ = 0.0;  ///< Behind a lag, away from 0 positive.
  int lower_gears_ = 0;
  double limited_s_ = 0.0;
  TravelLimit limit_ = TravelLimit::none;
};

}  // namespace rigwire::sim
