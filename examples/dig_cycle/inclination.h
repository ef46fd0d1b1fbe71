// How far one link is pitched, from the inertial sensor on it: the direction of gravity, steadied
// by the rate of turn.
//
// A complementary filter with a learnt rate offset. While the machine is quiet it follows gravity
// with time constant `quiet_time_constant_s`; while anything moves, the accelerations of the motion
// tilt the apparent vertical (1 m/s2 sideways is 6 degrees), so it then trusts the rate and pulls
// towards gravity only with `moving_time_constant_s`. A specific force that is not about g in size
// is not used at all.
//
// Error bound at rest: that of the accelerometer's offset, 1 mg = 0.06 degrees. In motion it drifts
// with what is left of the rate's offset, and with the mean horizontal acceleration.
#pragma once

namespace rigwire::dig_cycle {

struct InclinationSettings {
  double quiet_time_constant_s = 0.5;
  double moving_time_constant_s = 8.0;
  double offset_time_constant_s = 10.0;         ///< Learning of the rate's offset, quiet only.
  double largest_offset_radps = 0.02;           ///< Beyond it is motion, not offset.
  double largest_gravity_deviation_mps2 = 1.5;  ///< Specific force beyond g +- this is not used.
};

class Inclination {
 public:
  explicit Inclination(const InclinationSettings& settings = {});

  /// One rate sample, nose up positive, that stands for the last `step_s`.
  void rate(double pitch_rate_radps, double step_s);
  /// One acceleration sample: specific force along the link and square to it, upwards at rest.
  void specific_force(double along_mps2, double up_mps2, bool quiet, double step_s);

  [[nodiscard]] bool ready() const { return ready_; }
  /// Pitch of the link against the horizontal, (-pi, pi], nose up positive. 0 until ready.
  [[nodiscard]] double pitch_rad() const { return pitch_rad_; }
  /// The last rate with the learnt offset taken off.
  [[nodiscard]] double pitch_rate_radps() const { return pitch_rate_radps_; }
  [[nodiscard]] double rate_offset_radps() const { return offset_radps_; }

 private:
  InclinationSettings settings_;
  double pitch_rad_ = 0.0;
  double pitch_rate_radps_ = 0.0;
  double offset_radps_ = 0.0;
  bool ready_ = false;
};

}  // namespace rigwire::dig_cycle
