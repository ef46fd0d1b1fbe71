// A vehicle without dynamics for tests of field programs: a bicycle whose front and rear wheel
// steer, that follows curvature, crab angle and speed with a lag; and a receiver with correlated
// errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "field/geometry.h"

namespace rigwire::field {

struct VehiclePlant {
  double wheelbase_m = 3.85;
  double reference_m = 0.0;  ///< Place of the pose, ahead of the rear wheel.
  double steer_lag_s = 0.3;
  double steer_limit_rad = 0.55;
  double speed_lag_s = 0.6;
  // Orders.
  double curvature_1pm = 0.0;
  double crab_rad = 0.0;
  double wish_mps = 0.0;
  double brake_mps2 = 0.0;
  // State.
  PlanePosition position;
  double heading_rad = 0.0;
  double speed_mps = 0.0;  ///< Along the course.
  double front_rad = 0.0;
  double rear_rad = 0.0;
  double yaw_rate_radps = 0.0;
  double slip_rad = 0.0;

  void step(double h) {
    // With the reference at the rear wheel only the front one steers.
    if (reference_m > 0.0) {
      const double gamma = std::atan(0.5 * wheelbase_m * curvature_1pm);
      step_angles(h, crab_rad + gamma, crab_rad - gamma);
    } else {
      step_angles(h, std::atan(wheelbase_m * curvature_1pm), 0.0);
    }
    move(h);
  }

  void step_angles(double h, double front_wanted_rad, double rear_wanted_rad) {
    const auto follow = [&](double& angle, double wanted) {
      wanted = std::clamp(wanted, -steer_limit_rad, steer_limit_rad);
      angle += (wanted - angle) * std::min(1.0, h / steer_lag_s);
    };
    follow(front_rad, front_wanted_rad);
    follow(rear_rad, rear_wanted_rad);
  }

  void move(double h) {
    const double pull = std::clamp((wish_mps - speed_mps) / speed_lag_s, -1.0, 1.0);
    speed_mps += h * pull;
    const double brake = std::min(std::abs(speed_mps), brake_mps2 * h);
    speed_mps -= std::copysign(brake, speed_mps);
    const double share = reference_m / wheelbase_m;
    slip_rad = std::atan(share * std::tan(front_rad) + (1.0 - share) * std::tan(rear_rad));
    yaw_rate_radps =
        speed_mps * std::cos(slip_rad) * (std::tan(front_rad) - std::tan(rear_rad)) / wheelbase_m;
    const double course = heading_rad + slip_rad + 0.5 * h * yaw_rate_radps;
    position.east_m += h * speed_mps * std::cos(course);
    position.north_m += h * speed_mps * std::sin(course);
    heading_rad = wrapped(heading_rad + h * yaw_rate_radps);
  }
};

/// Position errors that wander (first-order Gauss-Markov) and some white noise; reported late.
class TestReceiver {
 public:
  TestReceiver(double wander_m, double white_m, unsigned seed)
      : wander_m_(wander_m), white_m_(white_m), random_(seed) {}

  PlanePosition measure(const PlanePosition& truth, double period_s) {
    constexpr double kCorrelation_s = 40.0;
    const double keep = std::exp(-period_s / kCorrelation_s);
    const double drive = wander_m_ * std::sqrt(1.0 - keep * keep);
    east_ = keep * east_ + drive * normal_(random_);
    north_ = keep * north_ + drive * normal_(random_);
    return {truth.east_m + east_ + white_m_ * normal_(random_),
            truth.north_m + north_ + white_m_ * normal_(random_)};
  }
  double normal() { return normal_(random_); }

 private:
  double wander_m_;
  double white_m_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double east_ = 0.0;
  double north_ = 0.0;
};

}  // namespace rigwire::field
