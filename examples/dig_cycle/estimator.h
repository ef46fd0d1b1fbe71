// What the program believes of its machine: joint angles from four inertial sensors and the swing
// encoder, nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {

/// A link is at rest after so many samples without a rate.
inline constexpr std::size_t kStillSamples = 20;

struct InclinationSettings {
  double quiet_time_constant_s = 0.5;
  double moving_time_constant_s = 20.0;
  double first_rest_s = 2.0;  ///< Length of the rest that tells the rate's offset at once.
  double offset_time_constant_s = 10.0;  ///< Learning of the rate's offset later, quiet only.
  double largest_offset_radps = 0.02;    ///< Beyond it is motion, not offset.
  double largest_gravity_deviation_mps2 = 1.5;  ///< Specific force beyond g +- this is not used.
};

/// How far one link is pitched, from the inertial sensor on it: the direction of gravity, steadied
/// by the rate of turn.
///
/// A complementary filter with a learnt rate offset. While the machine is quiet it follows gravity
/// with time constant `quiet_time_constant_s`; while anything moves, the accelerations of the
/// motion tilt the apparent vertical (1 m/s2 sideways is 6 degrees), so it then trusts the rate and
/// pulls towards gravity only with `moving_time_constant_s`. A specific force that is not about g
/// in size is not used at all.
///
/// Error bound at rest: that of the accelerometer's offset, 1 mg = 0.06 degrees. In motion it
/// drifts with what is left of the rate's offset, and with the mean horizontal acceleration.
class Inclination {
 public:
  explicit Inclination(const InclinationSettings& settings = {});

  /// Takes one rate sample, nose up positive, for the last `step_s`; `quiet`: nothing moves.
  void rate(double pitch_rate_radps, bool quiet, double step_s);
  /// Takes one acceleration sample: specific force along the link and square to it, upwards at
  /// rest.
  void specific_force(double along_mps2, double up_mps2, bool quiet, double step_s);

  [[nodiscard]] bool ready() const { return ready_; }
  /// Whether the first rest is over, so that the rate's offset is known.
  [[nodiscard]] bool rested() const { return first_rest_s_ >= settings_.first_rest_s; }
  /// Pitch of the link against the horizontal, (-pi, pi], nose up positive. 0 until ready.
  [[nodiscard]] double pitch_rad() const { return pitch_rad_; }
  /// The last rate with the learnt offset taken off.
  [[nodiscard]] double pitch_rate_radps() const { return pitch_rate_radps_; }
  [[nodiscard]] double rate_offset_radps() const { return offset_radps_; }

 private:
  /// Changes the rate's offset, within its limit.
  void learn(double change_radps);

  InclinationSettings settings_;
  double pitch_rad_ = 0.0;
  double pitch_rate_radps_ = 0.0;
  double offset_radps_ = 0.0;
  std::array<double, kStillSamples> errors_rad_{};  ///< Against gravity, at rest, the last ones.
  std::size_t next_ = 0;                            ///< Element that is written next.
  std::size_t waiting_ = 0;                         ///< Number of them from this rest.
  double first_rest_s_ = 0.0;                       ///< Time of the first rest so far.
  bool ready_ = false;
};

/// The links that carry an inertial sensor.
enum Link : std::size_t { chassis_link, boom_link, stick_link, bucket_link };
inline constexpr std::size_t kLinks = 4;

struct Belief {
  PerJoint angles_rad{};
  PerJoint rates_radps{};
  double chassis_pitch_rad = 0.0;
  bool ready = false;   ///< Every sensor has sent data.
  bool rested = false;  ///< Every inertial sensor was at rest for long enough to know its offset.
};

class Estimator {
 public:
  /// `imu_period_s`: time between two samples of a sensor, as configured in it. The samples are
  /// spaced by the sensor's own clock; the times of arrival are not used.
  explicit Estimator(double imu_period_s = 0.01, const InclinationSettings& settings = {});

  /// Pitch rate of the link, nose up positive.
  void imu_rate(Link link, double pitch_rate_radps);
  /// Specific force along the link and upwards. Not used while the machine swings.
  void imu_specific_force(Link link, double along_mps2, double up_mps2);
  void swing(double angle_rad, double rate_radps);

  [[nodiscard]] Belief belief() const;
  [[nodiscard]] const Inclination& inclination(Link link) const { return links_[link]; }

 private:
  [[nodiscard]] bool quiet() const;

  double imu_period_s_;
  std::array<Inclination, kLinks> links_;
  /// Joints that stop let the arm rock; quiet counts only after this many still samples.
  std::array<int, kLinks> still_samples_{};
  double swing_rad_ = 0.0;
  double swing_rate_radps_ = 0.0;
  bool swing_known_ = false;
};

}  // namespace rigwire::dig_cycle
