// Odometry as a machine computes it: from wheel speeds and steering angles through its kinematic
// model to speed, curvature and slip angle. The body's true motion does not enter, hence wheel slip
// shows as an error.
//
// Double Ackermann (bicycle with front and rear steer), reference point l_f behind the front and
// l_r ahead of the rear axle, L = l_f + l_r, steering angles left positive:
//
//     tan beta = (l_f tan delta_r + l_r tan delta_f) / L           slip angle
//     psi'     = v_x (tan delta_f - tan delta_r) / L               yaw rate
//     kappa    = cos beta (tan delta_f - tan delta_r) / L          curvature of the point's path
//
// A wheel at (x, y) from the reference point that rolls without slip along its own heading moves
// with |(v_x - psi' y, v_y + psi' x)|; inverted, each wheel gives an estimate of v_x, and their
// mean is the speed. With no slip and exact readings all of them are equal and exact.
//
// Wolf, Groll, Hemer, Berns, SIMULTECH 2020, section 5.
#pragma once

#include <array>

#include "fields/rules.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::sim {

enum class OdometryWheels {
  all,
  front,
  rear,
};

/// Defaults: Unimog U5023, reference point at the rear axle; wheelbase and track are estimates.
struct OdometryParameters {
  double front_distance_m = 3.85;  ///< l_f. Either may be 0 or negative, their sum not.
  double rear_distance_m = 0.0;    ///< l_r.
  double track_m = 1.94;           ///< Left to right wheel; 0 for drums.
  OdometryWheels wheels = OdometryWheels::all;

  friend bool operator==(const OdometryParameters&, const OdometryParameters&) = default;
};

void visit(fields::Visitor& v, OdometryParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const OdometryParameters& parameters);

/// Steering beyond this is taken as this, either side: the tangent has a pole at 90 degrees.
inline constexpr double kGreatestSteer_rad = 1.4;

/// From wheel_rate_radps, wheel_radius_m, front_steer_rad and rear_steer_rad of the sample. A wheel
/// whose rate or radius is not a finite number is left out; without any wheel the speed is 0; a
/// steering angle that is no number counts as 0. The result is always finite. Pure.
[[nodiscard]] OdometryReading odometry(const OdometryParameters& parameters,
                                       const VehicleSample& sample);

/// Yaw rate that a reading implies: curvature times the signed speed along the path.
[[nodiscard]] double yaw_rate_radps(const OdometryReading& reading);

}  // namespace rigwire::sim
