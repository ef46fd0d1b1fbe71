// Attitude with a heading, for units that send quaternions: the tilt of TiltFilter and a heading
// that the gyroscope carries on from where it was set. Without magnetometer and receiver nothing
// ever corrects the heading: it drifts with the gyroscope's bias, as that of every vertical
// reference unit does.
#pragma once

#include <array>

#include "emulators/inertial/filter.h"

namespace rigwire::emulators {

/// w, x, y, z; turns vectors of the sensor (x forward, y left, z up) into the local frame (x east,
/// y north, z up).
using Quaternion = std::array<double, 4>;

[[nodiscard]] Quaternion product(const Quaternion& a, const Quaternion& b);
[[nodiscard]] Quaternion conjugate(const Quaternion& q);
[[nodiscard]] Triad rotate(const Quaternion& q, const Triad& v);
/// The rotation by a vector of angles.
[[nodiscard]] Quaternion from_rotation_vector(const Triad& angles_rad);

struct RollPitchYawAngles {
  double roll_rad = 0.0;   ///< About x forward: right side down positive.
  double pitch_rad = 0.0;  ///< About y left: nose down positive.
  double yaw_rad = 0.0;    ///< About z up: counter-clockwise positive, 0 is x to the east.
};
[[nodiscard]] RollPitchYawAngles euler(const Quaternion& q);

class OrientationFilter {
 public:
  explicit OrientationFilter(double heading_rad) : heading_rad_(heading_rad) { reset(); }

  /// One step of `period_s`; x forward, y left, z up. At rest and level the specific force is
  /// (0, 0, +g).
  void step(const Triad& rate_radps, const Triad& specific_force_mps2, double period_s);
  /// Back to the heading of the constructor, tilt unknown.
  void reset();

  [[nodiscard]] const Quaternion& attitude() const { return attitude_; }
  [[nodiscard]] bool initialising() const { return tilt_.initialising(); }

 private:
  /// Turns the attitude by the smallest angle so that its "up" is the tilt filter's.
  void follow_tilt();

  double heading_rad_;
  TiltFilter tilt_;
  Quaternion attitude_{1.0, 0.0, 0.0, 0.0};
  Triad previous_rate_radps_{};
  bool started_ = false;
};

}  // namespace rigwire::emulators
