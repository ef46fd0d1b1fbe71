// An engine behind a friction clutch, as the shaft behind the clutch sees it.
//
// The clutch is solved as a stick-slip element, clamped last. Sticking, engine and input shaft have
// one speed at the end of the step, and the engine's inertia and slope appear at the shaft; where
// their speeds differ before, the step merges them and keeps their angular momentum. When the
// torque that this takes exceeds the capacity, the clutch slips with its capacity, the engine is
// solved by itself, and the shaft feels a torque only. Both sides always feel the same torque, so
// that the clutch can neither make momentum nor energy.
//
// Capacity: share(t) * capacity * law(speed), law from 0 at open_radps to 1 at full_radps, of the
// faster of the two sides where the clutch is automated, of the engine where it is centrifugal.
#pragma once

#include "sim/driveline/engine.h"
#include "sim/driveline/parameters.h"

namespace rigwire::sim {

/// At the input shaft: torque_nm - damping (w' - w) - inertia (w' - w) / h.
struct ShaftEquations {
  double torque_nm = 0.0;
  double damping_nmsprad = 0.0;
  double inertia_kgm2 = 0.0;
};

class ClutchedEngine {
 public:
  ClutchedEngine(const EngineParameters& engine, const ClutchParameters& clutch);

  /// `coupled` is false in neutral: no shaft behind the clutch.
  void begin(double h, const EngineDemand& demand, double capacity_share, bool coupled,
             double input_radps);
  [[nodiscard]] const ShaftEquations& equations() const { return equations_; }
  /// False: equations() have changed. True at the fourth call of a step at the latest.
  bool accept(double h, double input_radps);
  void finish(double h, double input_radps);

  /// The shaft's speed was changed by an impulse in which the engine's inertia took part.
  void follow(double input_radps);

  [[nodiscard]] bool sticks() const { return coupled_ && mode_ == Mode::stick; }
  [[nodiscard]] double speed_radps() const { return speed_radps_; }
  [[nodiscard]] double inertia_kgm2() const { return engine_.parameters().inertia_kgm2; }
  [[nodiscard]] double torque_nm() const { return torque_nm_; }  ///< Engine's, in the last step.
  [[nodiscard]] double clutch_torque_nm() const { return clutch_torque_nm_; }
  [[nodiscard]] double capacity_nm() const { return capacity_nm_; }
  /// Below the speed at which the clutch begins to close.
  [[nodiscard]] bool idling() const { return speed_radps_ <= clutch_.open_radps; }
  [[nodiscard]] EngineSample sample() const;
  /// Work of the engine's torque, and heat of the clutch, since the start.
  [[nodiscard]] double work_j() const { return work_j_; }
  [[nodiscard]] double clutch_heat_j() const { return clutch_heat_j_; }
  [[nodiscard]] const Engine& engine() const { return engine_; }

 private:
  enum class Mode { stick, slip };

  [[nodiscard]] double law(double speed_radps) const;
  [[nodiscard]] double capacity_at(double engine_radps, double input_radps) const;
  void set_stick(double h);
  void set_slip(double h, double direction);
  bool hold_engine_limits(double next_radps);

  Engine engine_;
  ClutchParameters clutch_;
  double speed_radps_;

  // State of the current step.
  bool coupled_ = false;
  Mode mode_ = Mode::slip;
  double direction_ = 1.0;  ///< Sign of the slip; positive: the engine is faster.
  double capacity_share_ = 0.0;
  double input_radps_ = 0.0;  ///< Speed of the clutch's input before the step.
  EngineTorque torque_;
  bool limited_ = false;
  int calls_ = 0;
  double next_radps_ = 0.0;  ///< Engine speed while slipping.
  ShaftEquations equations_;

  double torque_nm_ = 0.0;
  double clutch_torque_nm_ = 0.0;
  double capacity_nm_ = 0.0;
  double work_j_ = 0.0;
  double clutch_heat_j_ = 0.0;
  EngineCondition condition_;
};

}  // namespace rigwire::sim
