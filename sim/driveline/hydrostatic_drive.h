// A closed-loop hydrostatic drive: engine with governor, one variable pump, one motor in each of
// two drums.
//
//     C dp/dt = Q_pump - sum(D_i w_i) - k_leak p,     torque_i = D_i p,     |p| <= relief
//
// p is the pressure difference of the loop, D_i a motor's displacement per radian of its drum (gear
// included), w_i the drum's rate. Both motors hang on the same lines: equal pressure makes equal
// torque and lets the flow go where it is taken, like an open differential; a drum that slips takes
// it all. With the flow divider closed each drum has its own half of the flow and its own pressure.
//
// The pressure is stepped by the backward Euler rule, so that it enters the machine's velocity
// solve as p = offset - gain (flow taken); the relief valve is tested after the solve and leaves no
// wind-up. Pump: the set point ramps, the swash plate follows it with a lag, exactly (the step does
// not change where they are after a given time). Engine: governed speed falls in proportion to the
// pump's torque, with a lag; where the engine has no more torque the pump swivels back along the
// hyperbola of constant torque. A derated engine has less of it; one without fuel comes to rest as
// after ignition off.
//
// Estimates, but for the shape of the equations. There is no charge circuit: the low side always
// has the charge pressure.
#pragma once

#include <array>
#include <cstddef>

#include "fields/rules.h"
#include "sim/contact/bristle.h"
#include "sim/engine/power_unit_fault.h"
#include "sim/samples/engine_sample.h"

namespace rigwire::sim {

struct HydrostaticDriveParameters {
  /// Displacement of each motor, per radian of its drum.
  double motor_displacement_m3prad = 3.0e-4;
  double pump_displacement_m3prad = 1.40e-5;  ///< At full swash, per radian of the engine.
  double oil_volume_m3 = 1.0e-3;              ///< Under pressure.
  double bulk_modulus_pa = 1.4e9;             ///< Bulk modulus of oil and hoses.
  double leakage_m3pspa = 8.0e-13;            ///< Leakage of the pump and both motors.
  double relief_pressure_pa = 38.0e6;         ///< Pressure difference between the lines.
  double charge_pressure_pa = 2.2e6;          ///< Pressure of the low side.
  double motor_friction_nmsprad = 150.0;      ///< Viscous, of each motor at its drum.
  double ramp_mps2 = 0.8;                     ///< Rate limit of the travel set point.
  double swash_time_constant_s = 0.1;
  double speed_max_mps = 11.5 / 3.6;
  double engine_idle_radps = rpm(900);
  double engine_rated_radps = rpm(2200);
  double engine_torque_nm = 265.0;   ///< Maximum engine torque.
  double engine_drag_nm = 40.0;      ///< The engine's own friction, in addition to that torque.
  double engine_inertia_kgm2 = 0.6;  ///< For its data sheet.
  double engine_droop = 0.06;        ///< Share of speed lost at maximum torque.
  double engine_time_constant_s = 0.4;
  bool flow_divider = false;  ///< Closed from the start, whatever the command.
  bool bypass = false;        ///< Towing valves open: no pressure, drums turn freely.

  friend bool operator==(const HydrostaticDriveParameters&,
                         const HydrostaticDriveParameters&) = default;
};

void visit(fields::Visitor& v, HydrostaticDriveParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const HydrostaticDriveParameters& parameters);

/// One pressure: p = law.offset - law.gain * (displacement . drum rates).
struct HydrostaticCircuit {
  ImplicitForce law;
  std::array<double, 2> displacement_m3prad{};  ///< Front, rear; 0 where not connected.
};

/// Set points of the drive; every member must be a finite number.
struct HydrostaticDemand {
  double travel_speed_mps = 0.0;    ///< Surface speed of the drums, mean of both.
  double engine_speed_radps = 0.0;  ///< Set point of the governor; clamped to idle .. rated.
  bool flow_divider = false;
  bool ignition = true;  ///< Off: the engine comes to rest.
};

class HydrostaticDrive {
 public:
  /// `radius_m`: of the drums, with which speeds are turned into flows. Engine idling, no pressure.
  HydrostaticDrive(const HydrostaticDriveParameters& parameters, double radius_m);

  void command(const HydrostaticDemand& demand) { demand_ = demand; }

  /// What is wrong with its engine, until the next.
  void fail(const PowerUnitDefects& defects) { defects_ = defects; }

  /// Moves set point, swash plate and engine on by h > 0 and makes the circuits of this step.
  void begin(double h);
  /// Circuits of this step: one, or two with the flow divider closed.
  [[nodiscard]] std::size_t circuits() const { return divided_ ? 2 : 1; }
  [[nodiscard]] const HydrostaticCircuit& circuit(std::size_t index) const {
    return circuits_[index];
  }
  /// |p| of each circuit; 0 with the bypass open.
  [[nodiscard]] double pressure_limit_pa() const { return limit_pa_; }
  /// Ends the step with the pressures that the solve found, limited.
  void finish(const std::array<double, 2>& pressures_pa);

  /// After its ramp: what the pump is asked for.
  [[nodiscard]] double set_point_mps() const { return set_point_mps_; }
  /// Over the last step.
  [[nodiscard]] double mean_set_point_mps() const { return mean_set_point_mps_; }
  /// Loop pressure difference, driving forward positive; the mean of two circuits.
  [[nodiscard]] double pressure_pa() const;
  /// What a gauge on the high side reads.
  [[nodiscard]] double gauge_pressure_pa() const;
  [[nodiscard]] double pump_flow_m3ps() const { return pump_flow_m3ps_; }
  [[nodiscard]] double engine_speed_radps() const { return engine_speed_radps_; }
  /// Torque that the pump takes, as a share of the engine's maximum; negative when it drives the
  /// engine.
  [[nodiscard]] double engine_torque_share() const;
  /// Engine values for data sheet and sample; other members of the sample are not filled.
  [[nodiscard]] EngineData engine_data() const;
  [[nodiscard]] EngineSample engine_sample() const;
  [[nodiscard]] bool divided() const { return divided_; }
  [[nodiscard]] const HydrostaticDriveParameters& parameters() const { return parameters_; }

 private:
  [[nodiscard]] double pump_torque_nm() const;
  [[nodiscard]] double governor_radps() const;
  [[nodiscard]] bool runs() const { return demand_.ignition && defects_.fuel; }
  /// The most that the pump may take of the engine.
  [[nodiscard]] double torque_limit_nm() const;
  [[nodiscard]] double asked_swash() const;
  /// Opens or closes the flow divider.
  void connect();

  HydrostaticDriveParameters parameters_;
  double radius_m_;
  HydrostaticDemand demand_;
  PowerUnitDefects defects_;
  double set_point_mps_ = 0.0;
  double mean_set_point_mps_ = 0.0;
  double swash_ = 0.0;  ///< -1 .. 1, before the torque limit.
  double limited_swash_ = 0.0;
  double engine_speed_radps_;
  double pump_flow_m3ps_ = 0.0;
  double limit_pa_;
  bool divided_;
  std::array<double, 2> pressure_pa_{};  ///< Pressure of each circuit; equal while there is one.
  std::array<HydrostaticCircuit, 2> circuits_;
};

}  // namespace rigwire::sim
