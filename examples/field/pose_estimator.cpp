#include "field/pose_estimator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "field/geometry.h"

namespace rigwire::field {
namespace {

/// Speed below which the vehicle counts as standing.
constexpr double kStanding_mps = 0.02;
/// Maximum difference of one reading from the bias at standstill.
constexpr double kStandingGyro_radps = 0.02;
constexpr double kGate = 5.0;
/// After so many rejected fixes in a row the estimate itself is wrong.
constexpr int kMissesAllowed = 5;

double square(double value) {
  return value * value;
}

}  // namespace

PoseEstimator::PoseEstimator(const PoseEstimatorSettings& settings) : settings_(settings) {}

void PoseEstimator::start(const PlanePosition& antenna, double heading_rad,
                          double heading_sigma_rad) {
  const double c = std::cos(heading_rad);
  const double s = std::sin(heading_rad);
  x_ = {antenna.east_m - c * settings_.antenna_x_m + s * settings_.antenna_y_m,
        antenna.north_m - s * settings_.antenna_x_m - c * settings_.antenna_y_m, heading_rad, 0.0,
        0.0};
  p_ = {};
  p_[kEast][kEast] = p_[kNorth][kNorth] = square(settings_.gnss_sigma_m);
  p_[kHeading][kHeading] = square(heading_sigma_rad);
  p_[kBias][kBias] = square(settings_.bias_sigma_radps);
  p_[kScale][kScale] = square(settings_.scale_sigma);
  since_fix_s_ = 0.0;
  started_ = true;
}

void PoseEstimator::advance(double step_s, double speed_mps, double slip_angle_rad,
                            double gyro_radps) {
  since_fix_s_ += step_s;
  speed_mps_ = speed_mps;
  slip_angle_rad_ = slip_angle_rad;
  if (!started_ || step_s <= 0.0) {
    return;
  }
  const bool standing = std::abs(speed_mps) < kStanding_mps;
  if (standing) {
    yaw_rate_radps_ = 0.0;
    (void)correct(gyro_radps - x_[kBias], {0.0, 0.0, 0.0, 1.0, 0.0},
                  square(kStandingGyro_radps) / std::min(1.0, 10.0 * step_s), 1e3);
    return;
  }
  yaw_rate_radps_ = gyro_radps - x_[kBias];
  const double course = x_[kHeading] + slip_angle_rad + 0.5 * step_s * yaw_rate_radps_;
  const double way_m = speed_mps * (1.0 + x_[kScale]) * step_s;
  x_[kEast] += way_m * std::cos(course);
  x_[kNorth] += way_m * std::sin(course);
  x_[kHeading] = wrapped(x_[kHeading] + step_s * yaw_rate_radps_);

  // P = F P F' + Q, F being the identity but for five entries.
  const double east_heading = -way_m * std::sin(course);
  const double north_heading = way_m * std::cos(course);
  const auto add_row = [&](std::size_t to, std::size_t from, double factor) {
    for (std::size_t k = 0; k < kStates; ++k) {
      p_[to][k] += factor * p_[from][k];
    }
  };
  const auto add_column = [&](std::size_t to, std::size_t from, double factor) {
    for (std::size_t k = 0; k < kStates; ++k) {
      p_[k][to] += factor * p_[k][from];
    }
  };
  add_row(kEast, kHeading, east_heading);
  add_row(kNorth, kHeading, north_heading);
  add_row(kHeading, kBias, -step_s);
  add_column(kEast, kHeading, east_heading);
  add_column(kNorth, kHeading, north_heading);
  add_column(kHeading, kBias, -step_s);
  const double east_scale = speed_mps * step_s * std::cos(course);
  const double north_scale = speed_mps * step_s * std::sin(course);
  add_row(kEast, kScale, east_scale);
  add_row(kNorth, kScale, north_scale);
  add_column(kEast, kScale, east_scale);
  add_column(kNorth, kScale, north_scale);
  const double slip_variance = square(settings_.odometry_share * speed_mps) * step_s;
  p_[kEast][kEast] += slip_variance;
  p_[kNorth][kNorth] += slip_variance;
  p_[kHeading][kHeading] += square(settings_.gyro_sigma) * step_s;
  p_[kBias][kBias] += square(settings_.bias_walk) * step_s;
  p_[kScale][kScale] += square(settings_.scale_walk) * step_s;
}

bool PoseEstimator::correct(double innovation, const Vector& gradient, double variance,
                            double gate) {
  Vector ph{};
  double s = variance;
  for (std::size_t i = 0; i < kStates; ++i) {
    for (std::size_t k = 0; k < kStates; ++k) {
      ph[i] += p_[i][k] * gradient[k];
    }
    s += gradient[i] * ph[i];
  }
  if (square(innovation) > square(gate) * s) {
    return false;
  }
  for (std::size_t i = 0; i < kStates; ++i) {
    x_[i] += ph[i] / s * innovation;
  }
  for (std::size_t i = 0; i < kStates; ++i) {
    for (std::size_t k = 0; k < kStates; ++k) {
      p_[i][k] -= ph[i] * ph[k] / s;
    }
  }
  x_[kHeading] = wrapped(x_[kHeading]);
  return true;
}

void PoseEstimator::position(const PlanePosition& antenna) {
  if (!started_) {
    return;
  }
  const double period_s = std::clamp(since_fix_s_, 0.05, settings_.gnss_correlation_s);
  since_fix_s_ = 0.0;
  const double variance =
      square(settings_.gnss_sigma_m) * std::max(1.0, settings_.gnss_correlation_s / period_s);
  const double c = std::cos(x_[kHeading]);
  const double s = std::sin(x_[kHeading]);
  const double course = x_[kHeading] + slip_angle_rad_;
  const double behind_m = speed_mps_ * settings_.gnss_age_s;
  const double arm_east = c * settings_.antenna_x_m - s * settings_.antenna_y_m;
  const double arm_north = s * settings_.antenna_x_m + c * settings_.antenna_y_m;
  const double east = antenna.east_m - (x_[kEast] + arm_east - behind_m * std::cos(course));
  const double north = antenna.north_m - (x_[kNorth] + arm_north - behind_m * std::sin(course));
  if (std::hypot(east, north) >
      kGate * std::sqrt(square(settings_.gnss_sigma_m) + p_[kEast][kEast] + p_[kNorth][kNorth])) {
    ++rejected_;
    if (++misses_ <= kMissesAllowed) {
      return;
    }
    p_[kEast][kEast] += square(east);
    p_[kNorth][kNorth] += square(north);
  }
  misses_ = 0;
  constexpr double kNoGate = 1e6;
  (void)correct(east, {1.0, 0.0, -arm_north, 0.0, 0.0}, variance, kNoGate);
  (void)correct(north, {0.0, 1.0, arm_east, 0.0, 0.0}, variance, kNoGate);
}

void PoseEstimator::course(double course_rad, double ground_speed_mps) {
  if (!started_ || std::abs(speed_mps_) < settings_.least_course_speed_mps ||
      ground_speed_mps < settings_.least_course_speed_mps) {
    return;
  }
  const double reverse = speed_mps_ < 0.0 ? std::numbers::pi : 0.0;
  // The antenna is carried round by the turn as well.
  const double lever = std::atan2(yaw_rate_radps_ * settings_.antenna_x_m, std::abs(speed_mps_)) *
                       (speed_mps_ < 0.0 ? -1.0 : 1.0);
  const double expected =
      x_[kHeading] - settings_.gnss_age_s * yaw_rate_radps_ + slip_angle_rad_ + reverse + lever;
  const double variance = square(settings_.course_sigma_mps / ground_speed_mps) *
                          std::max(1.0, 1.0 / std::max(0.05, since_fix_s_));
  if (!correct(wrapped(course_rad - expected), {0.0, 0.0, 1.0, 0.0, 0.0}, variance, kGate)) {
    ++rejected_;
  }
}

Pose PoseEstimator::pose() const {
  Pose pose;
  pose.position = {x_[kEast], x_[kNorth]};
  pose.heading_rad = x_[kHeading];
  pose.speed_mps = speed_mps_;
  pose.yaw_rate_radps = yaw_rate_radps_;
  pose.slip_angle_rad = slip_angle_rad_;
  pose.position_sigma_m = std::sqrt(std::max(0.0, p_[kEast][kEast] + p_[kNorth][kNorth]));
  pose.heading_sigma_rad = std::sqrt(std::max(0.0, p_[kHeading][kHeading]));
  pose.since_fix_s = since_fix_s_;
  return pose;
}

std::optional<std::string> lost(const Pose& pose, double allowed_m) {
  constexpr double kPatience_s = 3.0;
  if (pose.since_fix_s < kPatience_s || 2.0 * pose.position_sigma_m < allowed_m) {
    return std::nullopt;
  }
  char text[160];
  (void)std::snprintf(text, sizeof(text),
                      "no position for %.1f s: it may be %.1f m from where it is believed, allowed "
                      "%.1f m",
                      pose.since_fix_s, 2.0 * pose.position_sigma_m, allowed_m);
  return text;
}

}  // namespace rigwire::field
