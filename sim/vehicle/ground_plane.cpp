#include "sim/vehicle/ground_plane.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace rigwire::sim {

Eigen::Isometry3d place_on_ground(const Ground& ground, const WheeledVehicleParameters& parameters,
                                  const VehiclePlace& place) {
  if (!std::isfinite(place.x_m) || !std::isfinite(place.y_m) || !std::isfinite(place.yaw_rad)) {
    throw std::invalid_argument("place: found a value that is not finite, allowed: finite numbers");
  }
  const Eigen::Vector2d ahead(std::cos(place.yaw_rad), std::sin(place.yaw_rad));
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  std::array<Eigen::Vector3d, 4> foot;
  for (std::size_t i = 0; i < 4; ++i) {
    const VehicleAxleParameters& axle = i < 2 ? parameters.front : parameters.rear;
    const double side = (i % 2 == 0 ? 0.5 : -0.5) * axle.track_m;
    const Eigen::Vector2d at = Eigen::Vector2d(place.x_m, place.y_m) +
                               (axle.position_x_m - parameters.rear.position_x_m) * ahead +
                               side * left;
    const double ceiling = ground.height_m(at.x(), at.y()) + axle.tyre.unloaded_radius_m;
    foot[i] = {at.x(), at.y(), ground.at(at.x(), at.y(), ceiling).height_m};
  }
  // x through the axles' mean feet, z square to x and to the sides' mean difference.
  const Eigen::Vector3d front = 0.5 * (foot[0] + foot[1]);
  const Eigen::Vector3d rear = 0.5 * (foot[2] + foot[3]);
  const Eigen::Vector3d across = 0.5 * (foot[0] + foot[2]) - 0.5 * (foot[1] + foot[3]);
  const Eigen::Vector3d x = (front - rear).normalized();
  const Eigen::Vector3d z = x.cross(across).normalized();
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.linear().col(0) = x;
  X_WB.linear().col(1) = z.cross(x);
  X_WB.linear().col(2) = z;
  X_WB.translation() = rear - parameters.rear.position_x_m * x;
  return X_WB;
}

}  // namespace rigwire::sim
