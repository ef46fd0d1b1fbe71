// The vehicle with 3 degrees of freedom in the plane of the ground and 4 wheel spins: slip, locks,
// brakes and drive line as at the full level, no suspension.
//
// Wheel loads: statics of the rigid vehicle under the specific force of the last steps (lag
// 0.1 s), split across by the axles' roll stiffness; never negative. Body: lies on the ground
// (ground_follower.h). For odometry with slip and road speeds, not for rough ground.
#pragma once

#include <Eigen/Core>
#include <array>

#include "sim/vehicle/ground_follower.h"
#include "sim/vehicle/obstacle_contact.h"
#include "sim/vehicle/suspension.h"
#include "sim/vehicle/velocity_system.h"
#include "sim/vehicle/wheel_terms.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

class PlanarVehicle final : public WheeledVehicle {
 public:
  PlanarVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                std::unique_ptr<Driveline> driveline, const VehiclePlace& place);

  void start_rolling(double speed_mps) override;

 private:
  void inner_step(double h) override;
  void update_links() override;
  void load_wheels(double h);
  void meet_obstacles(double h, const Velocities& start);

  GroundFollower follower_;
  std::array<WheelTerms, kWheels> wheel_terms_;
  std::array<WheelFrame, kWheels> frames_;
  std::array<ContactLink, kWheeledLinks.size()> contact_links_;
  std::vector<VehicleContactRows> contact_rows_;
  bool near_ = false;  ///< Obstacles may be within reach in this step.
  double yaw_inertia_kgm2_ = 0.0;
  std::array<double, 2> roll_share_{};  ///< Share of each axle in the lateral load transfer.
  /// Velocity of the centre of mass, axes of B.
  Eigen::Vector2d velocity_mps_ = Eigen::Vector2d::Zero();
  double yaw_rate_radps_ = 0.0;
  Eigen::Vector2d acceleration_mps2_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d transfer_mps2_ = Eigen::Vector2d::Zero();  ///< Lagged specific force.
  std::array<double, kWheels> load_n_{};
  std::array<double, kWheels> rate_radps_{};
  std::array<double, kWheels> spin_rad_{};
  std::array<double, kWheels> rate_radps2_{};
};

}  // namespace rigwire::sim
