// From the engine to four wheels: what a drive line adds to the equations of the wheels' spin.
//
// The vehicle solves all its velocities together; the drive line contributes a part that is linear
// in the wheel rates w' at the end of the step,
//
//     torque on the wheels = torque_nm - damping (w' - w) - inertia (w' - w) / h,
//
// and the subspace in which the rates may lie: a locked differential removes a coordinate, it is no
// stiff clutch. Tyres, brakes and the wheels' own inertia belong to the vehicle.
//
// Wheels as in sim/samples/vehicle_sample.h, rates about the axle, forward positive.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "sim/driveline/parameters.h"
#include "sim/engine/power_unit_fault.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::sim {

using WheelVector = Eigen::Vector4d;
using WheelMatrix = Eigen::Matrix4d;

struct SpinEquations {
  /// Reflected to the wheels: engine and shafts; positive semidefinite.
  WheelMatrix inertia = WheelMatrix::Zero();
  WheelVector torque_nm = WheelVector::Zero();
  WheelMatrix damping =
      WheelMatrix::Zero();  ///< Slope of the torques of engine, governor and couplers.
  /// Rates are basis.leftCols(coordinates) times that many numbers. The identity when nothing is
  /// locked.
  WheelMatrix basis = WheelMatrix::Identity();
  int coordinates = 4;
};

/// State of a drive line for a travel speed controller. Rates and torques of the wheels are those
/// of all driven wheels together, forward positive.
struct DriveState {
  int gear = 0;
  bool shifting = false;
  double rate_radps = 0.0;  ///< Mean of the wheels.
  double ratio = 0.0;       ///< Engine to wheels; reverse negative, 0 in neutral.
  double torque_nm = 0.0;   ///< On the wheels, through the clutch.
  /// Inertia at the wheels of what turns with them; includes the engine while the clutch sticks.
  double inertia_kgm2 = 0.0;
  double engine_radps = 0.0;
  double maximum_radps = 0.0;  ///< Speed up to which the engine has its full torque.
  double least_nm = 0.0;       ///< Engine torque at its speed: without fuel ...
  double greatest_nm = 0.0;    ///< ... and at full load.
  double governor_nmsprad = 0.0;
};

class Driveline {
 public:
  virtual ~Driveline() = default;
  Driveline(const Driveline&) = delete;
  Driveline& operator=(const Driveline&) = delete;

  /// Applies engine control, gear, group and locks. A request that cannot be executed yet (a lock
  /// while its wheels differ too much, a group change while rolling) waits, and is reported as
  /// requested.
  virtual void command(const VehicleCommand& command) = 0;

  /// Sets the engine's defects, until the next call.
  virtual void fail(const PowerUnitDefects& defects) = 0;

  /// Begins a step: lags, shift sequence, lock engagement. May change `rates` where coupling parts
  /// merge their speeds; then the angular momentum of what is coupled is kept.
  /// `wheel_inertia_kgm2` is of each wheel by itself.
  virtual void begin(double h, double wheel_inertia_kgm2, WheelVector& rates) = 0;

  /// Equations for this step at the present rates. Pure with respect to time.
  [[nodiscard]] virtual const SpinEquations& equations() const = 0;

  /// The rates that the vehicle's solve found. False when a coupling changed state under them
  /// (clutch sticks or slips, one-way clutch): the equations have changed and the step is to be
  /// solved again. True after at most four calls per step.
  virtual bool accept(double h, const WheelVector& rates) = 0;

  /// Ends the step with the accepted rates: engine speed, wear of nothing.
  virtual void finish(double h, const WheelVector& rates) = 0;

  /// Fills engine, gearbox and lock members.
  virtual void read(VehicleSample& sample) const = 0;
  /// Its engine's data sheet.
  [[nodiscard]] virtual EngineData engine_data() const = 0;

  [[nodiscard]] virtual DriveState state() const = 0;
  /// The gear for wheels that turn at `rate_radps` now and shall come to `target_radps` (not 0),
  /// both with their sign; the one that is engaged or asked for where another would not help.
  /// `lower` gears below the usual one, where those exist: for a climb.
  [[nodiscard]] virtual int select_gear(double rate_radps, double target_radps,
                                        int lower) const = 0;

 protected:
  Driveline() = default;
};

/// In neutral, engine at idle. Throws as validate() does.
[[nodiscard]] std::unique_ptr<Driveline> make_driveline(const DrivelineParameters& parameters);

}  // namespace rigwire::sim
