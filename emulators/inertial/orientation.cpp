#include "emulators/inertial/orientation.h"

#include <algorithm>
#include <cmath>

namespace rigwire::emulators {
namespace {

Quaternion normalised(const Quaternion& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

/// Forward, left, up to the tilt filter's forward, right, down, and back.
Triad flipped(const Triad& v) {
  return {v[0], -v[1], -v[2]};
}

}  // namespace

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

Triad rotate(const Quaternion& q, const Triad& v) {
  const Quaternion turned = product(product(q, {0.0, v[0], v[1], v[2]}), conjugate(q));
  return {turned[1], turned[2], turned[3]};
}

Quaternion from_rotation_vector(const Triad& angles_rad) {
  const double angle = std::hypot(angles_rad[0], angles_rad[1], angles_rad[2]);
  // sin(x/2)/x, with its limit.
  const double factor = angle < 1e-9 ? 0.5 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), factor * angles_rad[0], factor * angles_rad[1],
          factor * angles_rad[2]};
}

RollPitchYawAngles euler(const Quaternion& q) {
  RollPitchYawAngles angles;
  // Angles of the rotation z-y-x (yaw, pitch, roll).
  angles.roll_rad =
      std::atan2(2.0 * (q[0] * q[1] + q[2] * q[3]), 1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]));
  angles.pitch_rad = std::asin(std::clamp(2.0 * (q[0] * q[2] - q[3] * q[1]), -1.0, 1.0));
  angles.yaw_rad =
      std::atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]));
  return angles;
}

void OrientationFilter::reset() {
  tilt_.reset();
  started_ = false;
  attitude_ = from_rotation_vector({0.0, 0.0, heading_rad_});
}

void OrientationFilter::step(const Triad& rate_radps, const Triad& specific_force_mps2,
                             double period_s) {
  tilt_.step(flipped(rate_radps), flipped(specific_force_mps2), period_s);
  if (started_) {
    // Quaternion of the rotation vector of the trapezoidal mean rate.
    const auto mean = [&](std::size_t i) {
      return 0.5 * (rate_radps[i] + previous_rate_radps_[i]) * period_s;
    };
    attitude_ = product(attitude_, from_rotation_vector({mean(0), mean(1), mean(2)}));
  }
  previous_rate_radps_ = rate_radps;
  started_ = true;
  follow_tilt();
}

void OrientationFilter::follow_tilt() {
  const Triad wanted = flipped(tilt_.up());
  const Triad present = rotate(conjugate(attitude_), {0.0, 0.0, 1.0});
  // From the wanted direction to the present one, in the sensor's frame: half-way quaternion.
  const Quaternion turn{
      1.0 + wanted[0] * present[0] + wanted[1] * present[1] + wanted[2] * present[2],
      wanted[1] * present[2] - wanted[2] * present[1],
      wanted[2] * present[0] - wanted[0] * present[2],
      wanted[0] * present[1] - wanted[1] * present[0]};
  constexpr double kOpposite = 1e-9;
  attitude_ = turn[0] < kOpposite ? product(attitude_, {0.0, 1.0, 0.0, 0.0})
                                  : product(attitude_, normalised(turn));
  attitude_ = normalised(attitude_);
}

}  // namespace rigwire::emulators
