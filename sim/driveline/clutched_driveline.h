// What drive lines with one engine, one clutch and three differentials share: from the engine
// through a ratio to the wheels, as a part of the vehicle's equations.
//
// The gearbox's output turns at axle ratio * s.w, with s the share of each wheel: 1/4 each behind a
// centre differential, 1/2 each on a driven axle. Torque on the wheels is s times the ratio times
// the shaft's torque, inertia s s^T times the squared ratio: powers on both sides are equal, for
// every ratio.
#pragma once

#include "sim/driveline/clutched_engine.h"
#include "sim/driveline/differential_locks.h"
#include "sim/driveline/driveline.h"

namespace rigwire::sim {

/// Energies since the start. Power in = power out + loss holds for each step to rounding, with
/// rates halfway between its ends: engine = wheels + clutch + drag + locks + energy stored by the
/// inertias.
struct DrivelineEnergy {
  double engine_j = 0.0;  ///< Work of the engine's torque.
  double clutch_heat_j = 0.0;
  double drag_heat_j = 0.0;  ///< Heat of the drag on the gearbox's output.
  double lock_heat_j = 0.0;  ///< Lost where locks engaged, by wheels, shafts and engine.
};

class ClutchedDriveline : public Driveline {
 public:
  void command(const VehicleCommand& command) final;
  void fail(const PowerUnitDefects& defects) final { defects_ = defects; }
  void begin(double h, double wheel_inertia_kgm2, WheelVector& rates) final;
  [[nodiscard]] const SpinEquations& equations() const final { return equations_; }
  bool accept(double h, const WheelVector& rates) final;
  void finish(double h, const WheelVector& rates) final;
  void read(VehicleSample& sample) const final;
  [[nodiscard]] EngineData engine_data() const final;
  [[nodiscard]] DriveState state() const final;

  [[nodiscard]] DrivelineEnergy energy() const;
  [[nodiscard]] double engine_speed_radps() const { return engine_.speed_radps(); }
  [[nodiscard]] double clutch_torque_nm() const { return engine_.clutch_torque_nm(); }
  [[nodiscard]] bool clutch_sticks() const { return engine_.sticks(); }
  /// Engine to mean wheel rate; reverse negative, 0 in neutral.
  [[nodiscard]] double overall_ratio() const { return transmission_.ratio * axles_.ratio(); }
  [[nodiscard]] const WheelVector& shares() const { return shares_; }

 protected:
  /// State of the gearbox or variator in a step.
  struct Transmission {
    double ratio = 0.0;           ///< Input to output; 0 in neutral.
    double capacity_share = 1.0;  ///< Share of the clutch's torque capacity.
    EngineDemand demand;
    int gear = 0;
    bool crawler_group = false;
    bool shifting = false;
  };

  ClutchedDriveline(const EngineParameters& engine, const ClutchParameters& clutch,
                    const AxleParameters& axles);

  /// The new command's gear and group; all its numbers are finite and in range.
  virtual void request(const VehicleCommand& command) = 0;
  /// Moves on by h seconds; `output_radps` is the gearbox's output.
  virtual void advance(double h, double output_radps, Transmission& transmission) = 0;

  [[nodiscard]] const VehicleCommand& command() const { return command_; }
  [[nodiscard]] EngineDemand driver_demand() const;
  [[nodiscard]] const ClutchedEngine& engine() const { return engine_; }
  [[nodiscard]] double axle_ratio() const { return axles_.ratio(); }

 private:
  /// Cuts what is asked of the engine to what it can give.
  void limit(EngineDemand& demand) const;
  void make_equations();
  [[nodiscard]] double output_radps(const WheelVector& rates) const {
    return axles_.ratio() * shares_.dot(rates);
  }

  AxleParameters axles_;
  WheelVector shares_;
  WheelMatrix share_matrix_;  ///< s s^T
  ClutchedEngine engine_;
  double reference_torque_nm_;  ///< In the cylinders.
  PowerUnitDefects defects_;
  DifferentialLocks locks_;
  VehicleCommand command_;
  Transmission transmission_;
  SpinEquations equations_;
  double output_radps_ = 0.0;
  double drag_heat_j_ = 0.0;
  double lock_heat_j_ = 0.0;
};

}  // namespace rigwire::sim
