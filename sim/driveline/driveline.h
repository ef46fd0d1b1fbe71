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

#include "sim/samples/vehicle_sample.h"

namespace rigwire::sim {

using WheelVector = Eigen::Vector4d;
using WheelMatrix = Eigen::Matrix4d;

struct SpinEquations {
  WheelMatrix inertia = WheelMatrix::Zero();  ///< Reflected: engine, shafts; positive semidefinite.
  WheelVector torque_nm = WheelVector::Zero();
  WheelMatrix damping =
      WheelMatrix::Zero();  ///< Of the engine's and governor's slope, of couplers.
  /// Rates are basis.leftCols(coordinates) times that many numbers. The identity when nothing is
  /// locked.
  WheelMatrix basis = WheelMatrix::Identity();
  int coordinates = 4;
};

class Driveline {
 public:
  virtual ~Driveline() = default;
  Driveline(const Driveline&) = delete;
  Driveline& operator=(const Driveline&) = delete;

  /// Takes engine control, gear, group and locks; a request that cannot be met now (a lock while
  /// its wheels differ too much, a group change while rolling) waits, and shows as requested.
  virtual void command(const VehicleCommand& command) = 0;

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

 protected:
  Driveline() = default;
};

}  // namespace rigwire::sim
