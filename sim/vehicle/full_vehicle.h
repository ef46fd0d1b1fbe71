// The vehicle with 14 degrees of freedom: body 6, suspension 2 per axle, wheel spins 4.
//
// One step solves all velocities together, linearly implicit: springs, dampers, stops, tyres
// (normal, along, across, rolling), brakes, engine and chassis contacts are on the left-hand side
// with their slopes; then forces are compared with their limits (the ground cannot pull, friction,
// brake torque, clutch) and the step is solved again with forces beyond a limit held at it.
// Positions are advanced with the new velocities, the attitude by the exponential map.
//
// Wheel rates are against the axle, so that a locked differential removes an unknown. Torques of
// engine and brake act back on the axle (or body); the wheels' gyroscopic torque is kept.
// Gyroscopic terms of the body are taken at the rate in the middle of the step (torque-free
// prediction) and the attitude goes with the mean rate: second order in free flight.
//
// Linear in the step's error elsewhere. Cost and error: docs/machines/unimog-u5023.md.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "sim/vehicle/obstacle_contact.h"
#include "sim/vehicle/suspension.h"
#include "sim/vehicle/velocity_system.h"
#include "sim/vehicle/wheel_terms.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

/// C is the sprung body's centre of mass, B the body frame.
struct FullVehicleState {
  Eigen::Vector3d p_WC = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v_WC_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();
  std::array<double, 4> suspension{};  ///< Front 0, 1, rear 2, 3 (suspension.h).
  std::array<double, 4> suspension_rate{};
  std::array<double, kWheels> wheel_rate_radps{};
  std::array<double, kWheels> wheel_angle_rad{};
};

/// Momentum and energy of the whole vehicle, about the world's origin.
struct VehicleMomentum {
  Eigen::Vector3d linear_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_W = Eigen::Vector3d::Zero();
  double kinetic_j = 0.0;
  double potential_j = 0.0;  ///< Gravity only; springs are in spring_j.
  double spring_j = 0.0;     ///< Suspension, without stops and tyres; 0 in design position.
};

class FullVehicle final : public WheeledVehicle {
 public:
  FullVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
              std::unique_ptr<Driveline> driveline, const VehiclePlace& place);

  void start_rolling(double speed_mps) override;

  [[nodiscard]] const FullVehicleState& state() const { return state_; }
  /// Puts the vehicle anywhere, moving anyhow.
  void set_state(const FullVehicleState& state);
  /// Without what turns in the drive line.
  [[nodiscard]] VehicleMomentum momentum() const;
  /// Solves of the last inner step; 1 when nothing changed its set.
  [[nodiscard]] int passes() const { return passes_; }

 private:
  void inner_step(double h) override;
  void update_links() override;

  void stand(const VehiclePlace& place);
  void update_kinematics(const Eigen::Vector3d& w_B);
  void assemble(double h, const Eigen::Vector3d& w_B, const Velocities& start);
  void add_mass(double mass_kg, const UnsprungMass& part, std::size_t axle, double h,
                const Eigen::Vector3d& gravity_B);
  void add_suspension(double h, const Velocities& start);
  void add_syrup(double h, const Velocities& start);
  void contacts(double h, const Velocities& start);
  void meet_obstacles(double h, const Velocities& start);
  [[nodiscard]] bool finite(const Velocities& change);
  void advance(double h, const Velocities& found, const Velocities& change);

  std::array<AxleSuspension, 2> axles_;
  std::array<WheelTerms, kWheels> wheel_terms_;
  std::array<ContactLink, kWheeledLinks.size()> contact_links_;
  std::vector<VehicleContactRows> contact_rows_;
  bool near_ = false;                      ///< Obstacles may be within reach in this step.
  Eigen::Matrix3d whole_inertia_inverse_;  ///< In design position; for the gyroscopic prediction.
  Eigen::Matrix3d whole_inertia_;
  FullVehicleState state_;
  Eigen::Vector3d half_turn_ = Eigen::Vector3d::Zero();  ///< Mid-step rate less start rate.
  Velocities acceleration_{};
  VelocitySystem base_;
  int passes_ = 0;
  bool settling_ = false;
  double syrup_radps_ = 0.0;
};

}  // namespace rigwire::sim
