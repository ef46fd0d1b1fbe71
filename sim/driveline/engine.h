// A combustion engine's torque at its speed: full-load curve, friction, governors.
//
// Torque is at the crank, friction included: it lies between -friction (no fuel) and the full-load
// curve, which runs down to -friction between maximum and cut-off speed. The idle governor never
// lets it fall below what brings the engine back to idle; with the set-speed governor a
// proportional and an integral part act, the latter only while the torque is not at a limit.
#pragma once

#include "sim/driveline/parameters.h"

namespace rigwire::sim {

/// What the engine is asked for.
struct EngineDemand {
  EngineControl control = EngineControl::torque;
  double torque_share = 0.0;  ///< 0 .. 1 between friction and full load.
  double speed_radps = 0.0;   ///< With EngineControl::speed.
  double limit_share = 1.0;   ///< 0 .. 1 of full load that is not exceeded: a shift's ramp.
  bool fuel = true;           ///< Without it the engine drags, whatever is asked for.
};

/// Torque near a speed: torque_nm - damping (speed' - speed), to be cut to the limits.
struct EngineTorque {
  double torque_nm = 0.0;
  double damping_nmsprad = 0.0;  ///< Never negative: a rising curve counts as flat.
  double least_nm = 0.0;
  double greatest_nm = 0.0;
};

class Engine {
 public:
  /// Throws nothing; parameters as validate() lets them pass.
  explicit Engine(const EngineParameters& parameters);

  /// Accelerator's lag and governor's integral over h seconds at the present speed.
  void advance(double h, double speed_radps, const EngineDemand& demand);

  [[nodiscard]] EngineTorque torque(double speed_radps) const;

  [[nodiscard]] double full_load_nm(double speed_radps) const;
  [[nodiscard]] double friction_nm(double speed_radps) const;
  [[nodiscard]] double reference_torque_nm() const { return reference_torque_nm_; }
  [[nodiscard]] const EngineDemand& demand() const { return demand_; }
  [[nodiscard]] const EngineParameters& parameters() const { return parameters_; }

 private:
  EngineParameters parameters_;
  double reference_torque_nm_;
  EngineDemand demand_;
  double lagged_share_ = 0.0;
  double integral_nm_ = 0.0;
};

/// Returns the limit of the crank's torque as a share of full load at that speed, 0 .. 1, for
/// `torque_share` of `reference_nm`, the maximum torque in the cylinders
/// (EngineData::reference_torque_nm).
[[nodiscard]] double limit_share(const Engine& engine, double reference_nm, double torque_share,
                                 double speed_radps);

}  // namespace rigwire::sim
