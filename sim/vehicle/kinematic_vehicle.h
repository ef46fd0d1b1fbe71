// The vehicle as a bicycle that does not slip: position, heading, speed.
//
// The path follows from the steering angles alone. The speed follows from drive line, brakes,
// rolling resistance, slope and mass in one equation, the wheels' rates being tied to it; or, when
// a travel speed is commanded, from that with a first-order lag. Body: lies on the ground
// (ground_follower.h). Locked differentials have no effect on the path. For planners and scenes
// that need sensors only.
#pragma once

#include <array>

#include "sim/contact/bristle.h"
#include "sim/vehicle/ground_follower.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

class KinematicVehicle final : public WheeledVehicle {
 public:
  KinematicVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                   std::unique_ptr<Driveline> driveline, const VehiclePlace& place);

  void start_rolling(double speed_mps) override;
  [[nodiscard]] double speed_mps() const { return speed_mps_; }

 private:
  void inner_step(double h) override;
  void update_links() override;
  /// Wheel rates per speed, and yaw rate and sideways speed of B's origin per speed ahead.
  void update_geometry();
  /// Returns the speed at the end of the step.
  [[nodiscard]] double drive(double h);
  void meet_obstacles(double h);

  GroundFollower follower_;
  std::array<ContactLink, kWheeledLinks.size()> contact_links_;
  std::vector<std::array<double, 3>> contact_rows_;  ///< Speeds per speed along the path.
  bool near_ = false;                                ///< Obstacles may be within reach.
  Bristle hold_;  ///< Brakes and rolling resistance together, along the path.
  bool held_at_limit_ = false;
  double speed_mps_ = 0.0;  ///< Speed of B's origin, along its x.
  double curvature_1pm_ = 0.0;
  double sideways_ = 0.0;
  WheelVector rate_per_speed_ = WheelVector::Zero();
  std::array<double, kWheels> rate_radps_{};
  std::array<double, kWheels> rate_radps2_{};
  std::array<double, kWheels> spin_rad_{};
};

}  // namespace rigwire::sim
