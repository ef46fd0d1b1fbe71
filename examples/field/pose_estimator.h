// Where a vehicle is and where it points, from GNSS, odometry and a yaw gyroscope: an extended
// Kalman filter over east, north, heading, the gyroscope's bias and the odometry's scale (tyre
// radius, mean slip).
//
// - Between fixes: heading by the gyroscope less its bias, position by the wheels' speed along
//   heading + slip angle.
// - A fix corrects position; course over ground corrects the heading while the vehicle moves; both
//   are compared with where the vehicle was when the receiver measured.
// - At standstill the gyroscope's reading is its bias, and the heading rests.
// GNSS errors are correlated over time; a receiver that reports more often is not believed more:
// the variance of a fix is multiplied by correlation time over period.
// Knows neither wires nor clocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "field/geometry.h"

namespace rigwire::field {

struct PoseEstimatorSettings {
  double gnss_sigma_m = 1.5;        ///< Per axis.
  double gnss_correlation_s = 5.0;  ///< Correlation time of its errors.
  double gnss_age_s = 0.15;         ///< From measurement to arrival.
  double course_sigma_mps = 0.15;   ///< Standard deviation of the lateral velocity, for the course.
  double least_course_speed_mps = 0.7;
  double odometry_share = 0.05;    ///< Speed error per speed, correlated over a second.
  double scale_sigma = 0.04;       ///< Standard deviation of the odometry's scale at the start.
  double scale_walk = 0.002;       ///< 1/sqrt(s), while moving.
  double gyro_sigma = 0.002;       ///< rad/sqrt(s).
  double bias_walk = 2e-4;         ///< rad/s/sqrt(s).
  double bias_sigma_radps = 0.02;  ///< At the start.
  double antenna_x_m = 0.0;        ///< Ahead of the odometry's reference point.
  double antenna_y_m = 0.0;        ///< Left of it.
};

struct Pose {
  PlanePosition position;    ///< Position of the odometry's reference point.
  double heading_rad = 0.0;  ///< Heading of the body's x, left from east.
  double speed_mps = 0.0;    ///< By odometry, reverse negative.
  double yaw_rate_radps = 0.0;
  double slip_angle_rad = 0.0;  ///< Course against heading.
  double position_sigma_m = 0.0;
  double heading_sigma_rad = 0.0;
  double since_fix_s = 0.0;  ///< Since the last fix.
};

/// Why a machine that must be within `allowed_m` must not go on: there has been no fix for 3 s, and
/// it may be farther off than that by twice the standard deviation. Nothing while it may.
[[nodiscard]] std::optional<std::string> lost(const Pose& pose, double allowed_m);

class PoseEstimator {
 public:
  explicit PoseEstimator(const PoseEstimatorSettings& settings = {});

  /// First position of the antenna, and a guess of the heading with its standard deviation.
  void start(const PlanePosition& antenna, double heading_rad, double heading_sigma_rad);
  [[nodiscard]] bool started() const { return started_; }

  /// One step of `step_s` with the speed, slip angle and mean yaw rate (gyroscope) within it.
  void advance(double step_s, double speed_mps, double slip_angle_rad, double gyro_radps);
  /// A new fix.
  void position(const PlanePosition& antenna);
  /// Course over ground of the antenna, left from east, and its speed.
  void course(double course_rad, double ground_speed_mps);

  [[nodiscard]] Pose pose() const;
  [[nodiscard]] double bias_radps() const { return x_[kBias]; }
  /// Way over ground by way of the wheels, less 1.
  [[nodiscard]] double scale_error() const { return x_[kScale]; }
  /// Fixes and courses rejected as too far off.
  [[nodiscard]] std::uint64_t rejected() const { return rejected_; }

 private:
  enum State : std::size_t { kEast, kNorth, kHeading, kBias, kScale };
  static constexpr std::size_t kStates = 5;
  using Vector = std::array<double, kStates>;

  /// Corrects by one scalar: innovation, its gradient, its variance. False when beyond `gate`
  /// standard deviations.
  bool correct(double innovation, const Vector& gradient, double variance, double gate);

  PoseEstimatorSettings settings_;
  Vector x_{};
  std::array<Vector, kStates> p_{};
  double speed_mps_ = 0.0;
  double slip_angle_rad_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  double since_fix_s_ = 1.0;
  int misses_ = 0;  ///< Fixes refused in a row.
  std::uint64_t rejected_ = 0;
  bool started_ = false;
};

}  // namespace rigwire::field
