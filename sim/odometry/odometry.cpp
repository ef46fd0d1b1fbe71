#include "sim/odometry/odometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <stdexcept>

namespace rigwire::sim {
namespace {

void require(bool allowed_value, const char* name, double found, const char* allowed) {
  if (allowed_value) {
    return;
  }
  std::ostringstream text;
  text << name << ": found " << found << ", allowed " << allowed;
  throw std::invalid_argument(text.str());
}

double steering_tangent(double angle_rad) {
  return std::isfinite(angle_rad)
             ? std::tan(std::clamp(angle_rad, -kGreatestSteer_rad, kGreatestSteer_rad))
             : 0.0;
}

}  // namespace

void validate(const OdometryParameters& p) {
  require(std::isfinite(p.front_distance_m), "front_distance_m", p.front_distance_m, "a number");
  require(std::isfinite(p.rear_distance_m), "rear_distance_m", p.rear_distance_m, "a number");
  const double wheelbase = p.front_distance_m + p.rear_distance_m;
  require(wheelbase > 0.01, "front_distance_m + rear_distance_m", wheelbase, "above 0.01 m");
  require(std::isfinite(p.track_m) && p.track_m >= 0.0, "track_m", p.track_m, ">= 0 m");
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
      continue;  // the turn's centre is at this wheel: it tells nothing
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
