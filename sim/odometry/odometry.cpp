#include "sim/odometry/odometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

namespace {

constexpr std::array<fields::Choice<OdometryWheels>, 3> kOdometryWheels{
    {{OdometryWheels::all, "all", "Mean of all wheels."},
     {OdometryWheels::front, "front", "Front wheels or drum."},
     {OdometryWheels::rear, "rear", "Rear wheels or drum."}}};

double steering_tangent(double angle_rad) {
  return std::isfinite(angle_rad)
             ? std::tan(std::clamp(angle_rad, -kGreatestSteer_rad, kGreatestSteer_rad))
             : 0.0;
}

}  // namespace

void visit(fields::Visitor& v, OdometryParameters& p) {
  v.number("front_distance", p.front_distance_m, in("m").between(-100, 100),
           "Reference point to the front axle.");
  v.number("rear_distance", p.rear_distance_m, in("m").between(-100, 100),
           "Rear axle to the reference point.");
  v.number("track", p.track_m, in("m").at_least(0).at_most(100),
           "Left to right wheel; 0 for drums.");
  v.choice("wheels", p.wheels, kOdometryWheels, "Wheels whose rates give the speed.");
}

void validate(const OdometryParameters& p) {
  fields::check(p);
  fields::require(
      p.front_distance_m + p.rear_distance_m > 0.01, "front_distance",
      in("m").print(p.front_distance_m),
      "a wheelbase above 0.01 m together with rear_distance, " + in("m").print(p.rear_distance_m));
}

OdometryReading odometry(const OdometryParameters& p, const VehicleSample& sample) {
  const double wheelbase = p.front_distance_m + p.rear_distance_m;
  const double front = steering_tangent(sample.front_steer_rad);
  const double rear = steering_tangent(sample.rear_steer_rad);
  // Double Ackermann: tan(beta), and yaw rate per forward speed (odometry.h).
  const double slip_tangent = (p.front_distance_m * rear + p.rear_distance_m * front) / wheelbase;
  const double yaw_per_m = (front - rear) / wheelbase;

  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const bool is_front = i < 2;
    if ((is_front && p.wheels == OdometryWheels::rear) ||
        (!is_front && p.wheels == OdometryWheels::front)) {
      continue;
    }
    const double surface_mps = sample.wheel_rate_radps[i] * sample.wheel_radius_m[i];
    if (!std::isfinite(surface_mps)) {
      continue;
    }
    // Wheel's velocity per v_x. Its sign along the wheel: an inner wheel turns backwards when the
    // centre of the turn lies between the wheels.
    const double y = (i % 2 == 0 ? 0.5 : -0.5) * p.track_m;
    const double along = 1.0 - yaw_per_m * y;
    const double across = is_front ? front : rear;
    const double per_speed = std::copysign(std::hypot(along, across), along);
    if (std::abs(per_speed) < 1e-3) {
      continue;  // the turn's centre is at this wheel: its rate does not determine the speed
    }
    sum += surface_mps / per_speed;
    ++count;
  }

  OdometryReading reading;
  reading.speed_mps = count > 0 && std::isfinite(sum) ? sum / count : 0.0;
  reading.slip_angle_rad = std::atan(slip_tangent);
  // kappa = cos(beta) (tan f - tan r) / L.
  reading.curvature_1pm = yaw_per_m / std::hypot(1.0, slip_tangent);
  return reading;
}

double yaw_rate_radps(const OdometryReading& reading) {
  return reading.curvature_1pm * reading.speed_mps / std::cos(reading.slip_angle_rad);
}

}  // namespace rigwire::sim
