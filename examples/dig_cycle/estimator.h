// What the program believes of its machine: joint angles from four inertial sensors and the swing
// encoder, nothing else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "dig_cycle/inclination.h"
#include "dig_cycle/machine.h"

namespace rigwire::dig_cycle {

/// The links that carry an inertial sensor.
enum Link : std::size_t { chassis_link, boom_link, stick_link, bucket_link };
inline constexpr std::size_t kLinks = 4;
inline constexpr std::array<std::string_view, kLinks> kLinkNames{"imu_chassis", "imu_boom",
                                                                 "imu_stick", "imu_bucket"};

struct Belief {
  PerJoint angles_rad{};
  PerJoint rates_radps{};
  double chassis_pitch_rad = 0.0;
  bool ready = false;  ///< Every sensor has spoken.
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
