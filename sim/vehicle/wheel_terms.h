// One wheel's forces in the velocity solve: tyre along, across and square to the ground, rolling
// resistance, what soft soil takes, brake. Linear while they may be; held at their limits where the
// solve has shown them beyond (clamp last).
#pragma once

#include "sim/contact/bristle.h"
#include "sim/tyre/tyre.h"
#include "sim/vehicle/suspension.h"
#include "sim/vehicle/velocity_system.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

class WheelTerms {
 public:
  WheelTerms(const VehicleAxleParameters& axle, double carried_mass_kg, std::size_t wheel,
             double brake_stiffness_nmprad);

  /// Rows and laws for a step from velocities `start`. `contact`: of the wheel's disc, in W, on
  /// `ground`.
  void begin(double h, const WheelFrame& frame, const Eigen::Matrix3d& R_WB,
             const std::optional<WheelContact>& contact, const Ground& ground, double pressure_pa,
             double brake_limit_nm, const Velocities& start);
  /// Adds all forces, and the wheel's own inertia of spin.
  void add(double h, const Velocities& start, VelocitySystem& system) const;
  /// True when the velocities found ask for another set of forces held at their limits.
  [[nodiscard]] bool changes(const Velocities& found);
  /// Ends the step and reports the wheel's motion and forces in `state`.
  void settle(double h, const Velocities& found, WheelState& state);
  /// Leaves this step's rut in the ground on which it began.
  void press(const Ground& ground) const;

  [[nodiscard]] double spin_inertia_kgm2() const { return spin_inertia_kgm2_; }
  [[nodiscard]] const Tyre& tyre() const { return tyre_; }

 private:
  Tyre tyre_;
  Bristle brake_;
  BristleParameters brake_bristle_;
  double spin_inertia_kgm2_;
  std::size_t wheel_;

  TyreLaws laws_;
  ImplicitForce brake_law_;
  double brake_limit_nm_ = 0.0;
  WheelContact contact_;
  Eigen::Vector3d forward_W_ = Eigen::Vector3d::UnitX();
  double shift_m_ = 0.0;  ///< Distance of the lateral force ahead of the wheel's centre.
  double way_ = 1.0;      ///< Last direction of the wheel's centre: 1 forward, -1 back.
  VelocityRow normal_;
  VelocityRow along_;
  VelocityRow across_;
  VelocityRow centre_;  ///< Along the ground, forward.
  VelocityRow spin_;

  bool lifted_ = false;
  bool sliding_ = false;
  bool rolling_held_ = false;
  bool ploughing_held_ = false;
  bool brake_held_ = false;
  double along_n_ = 0.0;  ///< While sliding.
  double across_n_ = 0.0;
  double rolling_nm_ = 0.0;   ///< While held.
  double ploughing_n_ = 0.0;  ///< While held.
  double brake_nm_ = 0.0;     ///< While held.
};

}  // namespace rigwire::sim
