#include "sim/gnss/navigation_engine.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

// A recorded loss of all satellites, u-blox 7 at 1 Hz.
constexpr double kVelocityHeld_s = 10.0;
constexpr double kSurprised_s = 12.0;
constexpr double kSurprise = 3.1622776601683795;  // tenfold variance
constexpr double kGrowth = 0.9;
constexpr double kGrowthPerSecond = 0.04;
constexpr double kGreatestGrowth = 1.34;

}  // namespace

void NavigationEngine::forget() {
  filter_.forget();
  held_.reset();
  fixed_ = kNever;
}

void NavigationEngine::predict(const Epoch& epoch, double noise_factor) {
  const double step_s = last_ == kNever ? 0.0 : to_seconds(epoch.time - last_);
  last_ = epoch.time;
  NavigationNoise noise = epoch.noise;
  noise.horizontal *= noise_factor;
  noise.vertical *= noise_factor;
  filter_.predict(step_s, noise, epoch.correlation, epoch.truth.ned_from_world);
}

NavigationFix NavigationEngine::state(const Epoch& epoch) const {
  NavigationFix fix;
  fix.p_W = filter_.p_W();
  fix.v_W = epoch.still ? Eigen::Vector3d::Zero() : filter_.v_W();
  fix.clock_m = filter_.clock_m();
  fix.clock_rate_mps = filter_.clock_rate_mps();
  const Eigen::Matrix3d& turn = epoch.truth.ned_from_world;
  fix.covariance_ned_m2 = turn * filter_.position_covariance_m2() * turn.transpose();
  const Eigen::Matrix3d& c = fix.covariance_ned_m2;
  fix.horizontal_sigma_m = std::sqrt(std::max(0.0, c(0, 0) + c(1, 1)));
  fix.vertical_sigma_m = std::sqrt(std::max(0.0, c(2, 2)));
  fix.speed_sigma_mps = std::sqrt(std::max(0.0, filter_.velocity_covariance().trace()));
  fix.clock_sigma_m = std::sqrt(std::max(0.0, filter_.clock_variance_m2()));
  return fix;
}

NavigationFix NavigationEngine::fix(const Epoch& epoch, std::span<const NavigationSignal> signals,
                                    const std::optional<NavigationFilter::Position>& position) {
  if (fixed_ != kNever && to_seconds(epoch.time - fixed_) > kVelocityHeld_s &&
      last_ != fixed_) {  // an outage, not a slow rate
    filter_.forget();
  }
  predict(epoch, 1.0);
  filter_.update(epoch.truth, signals, position, epoch.still);
  fixed_ = epoch.time;
  held_ = state(epoch);
  return *held_;
}

std::optional<NavigationFix> NavigationEngine::coast(const Epoch& epoch) {
  if (!held_) {
    last_ = epoch.time;
    return std::nullopt;
  }
  const double step_s = to_seconds(epoch.time - last_);
  const double lost_s = to_seconds(epoch.time - fixed_);
  predict(epoch, lost_s > kSurprised_s ? kSurprise : 1.0);
  const NavigationFix predicted = state(epoch);
  if (lost_s > kVelocityHeld_s) {
    held_->v_W.setZero();
  }
  held_->speed_sigma_mps = predicted.speed_sigma_mps;
  held_->clock_m = predicted.clock_m;
  held_->clock_rate_mps = predicted.clock_rate_mps;
  held_->clock_sigma_m = predicted.clock_sigma_m;
  // d pAcc / dt = sAcc min(1.34, 0.9 + 0.04 t), split between level and height in their present
  // ratio.
  const double before_m = std::hypot(held_->horizontal_sigma_m, held_->vertical_sigma_m);
  const double grown_m = predicted.speed_sigma_mps * step_s *
                         std::min(kGreatestGrowth, kGrowth + kGrowthPerSecond * lost_s);
  if (before_m > 0.0) {
    const double ratio = (before_m + grown_m) / before_m;
    held_->horizontal_sigma_m *= ratio;
    held_->vertical_sigma_m *= ratio;
    held_->covariance_ned_m2 *= ratio * ratio;
  }
  return held_;
}

}  // namespace rigwire::sim
