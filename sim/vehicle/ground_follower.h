// A body that lies on the ground: height and slope under four wheels, smoothed as a suspension
// would, with velocities and accelerations that belong to them.
//
// Height and the two slopes of the plane through the four ground points follow it by
// y'' = w^2 (y_ground - y) + 2 w (y_ground' - y'), critically damped, solved implicitly. On an even
// slope, however steep, it follows without lag.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "sim/contact/contact_set.h"
#include "sim/ground/ground.h"
#include "sim/link_motion.h"
#include "sim/vehicle/parameters.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

/// Maximum height above the body's ground plane at which an obstacle carries a wheel of the axle; a
/// higher obstacle that the wheel is not on is solid to it (vehicle_contact()).
[[nodiscard]] double step_height_m(const VehicleAxleParameters& axle);

class GroundFollower {
 public:
  explicit GroundFollower(const WheeledVehicleParameters& parameters) : parameters_(&parameters) {}

  /// On the ground at rest.
  void reset(const Ground& ground, const VehiclePlace& place);
  /// Moves B's origin along its x and y with `speed` (in the plane of the body) and turns it by
  /// `yaw_rate` about its z, for h seconds.
  void step(double h, const Ground& ground, const Eigen::Vector2d& speed_mps,
            double yaw_rate_radps);
  /// Velocities from the next step on; no change of place.
  void set_speed(const Eigen::Vector2d& speed_mps);

  [[nodiscard]] const LinkMotion& body() const { return body_; }
  [[nodiscard]] Eigen::Matrix3d R_WB() const { return body_.X_WL.linear(); }
  /// Under the wheels; obstacles count up to step_height_m() above the body's ground plane.
  [[nodiscard]] const std::array<GroundPoint, kWheels>& ground() const { return points_; }
  /// Where those lie.
  [[nodiscard]] const std::array<Eigen::Vector3d, kWheels>& places() const { return places_; }
  [[nodiscard]] bool finite() const;

 private:
  struct Plane {
    double height_m = 0.0;                            ///< At B's origin.
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< d height / d (x, y) of W.
  };

  [[nodiscard]] Plane look(const Ground& ground);
  [[nodiscard]] Eigen::Matrix3d attitude() const;

  const WheeledVehicleParameters* parameters_;
  Eigen::Vector2d place_m_ = Eigen::Vector2d::Zero();
  double yaw_rad_ = 0.0;
  Eigen::Vector3d follow_ = Eigen::Vector3d::Zero();  ///< Height, slope east, slope north.
  Eigen::Vector3d follow_rate_ = Eigen::Vector3d::Zero();
  std::array<GroundPoint, kWheels> points_;
  std::array<Eigen::Vector3d, kWheels> places_;
  LinkMotion body_;
};

/// Computes the links of a vehicle whose axles are fixed in B (kWheeledLinks), from the body's
/// motion. Accelerations of the wheels' spins in rad/s2.
void rigid_links(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                 const std::array<double, 4>& steer_rad, const std::array<double, 4>& spin_rad,
                 const std::array<double, 4>& rate_radps, const std::array<double, 4>& rate_radps2,
                 const LinkMotion& body, std::array<LinkMotion, 7>& links);

/// Computes the links' poses and velocities for the contact, wheels without their spin.
void place_rigid_links(const WheeledVehicleParameters& parameters, const StaticLoads& loads,
                       const std::array<double, 4>& steer_rad, const LinkMotion& body,
                       std::array<ContactLink, 7>& links);

/// Origin of an axle's link in B, in design position: in the middle of its beam.
[[nodiscard]] Eigen::Vector3d axle_centre_m(const WheeledVehicleParameters& parameters,
                                            const StaticLoads& loads, std::size_t axle);

/// Middle of a wheel in B, in design position.
[[nodiscard]] Eigen::Vector3d wheel_centre_m(const WheeledVehicleParameters& parameters,
                                             const StaticLoads& loads, std::size_t wheel);

}  // namespace rigwire::sim
