// How a vehicle lies on the ground under its wheels.
#pragma once

#include <Eigen/Geometry>

#include "sim/ground/ground.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::sim {

/// Pose of B with the rear axle's middle over the place and the wheels' undersides on the ground,
/// by the heights under the four wheels: x along the middles of the axles' ground points, y
/// levelled across by the mean of front and rear. Throws std::invalid_argument when the place is
/// not finite.
[[nodiscard]] Eigen::Isometry3d place_on_ground(const Ground& ground,
                                                const WheeledVehicleParameters& parameters,
                                                const VehiclePlace& place);

}  // namespace rigwire::sim
