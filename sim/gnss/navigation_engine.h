// What a receiver makes of its filter from epoch to epoch: the fix, and what it goes on saying when
// the satellites are gone.
//
// Without a fix the velocity is held for 10 s and is zero then; the position stays the last one.
// The variance of the speed grows by the filter's process noise, ten times as fast from 12 s on;
// the accuracy of the position grows by 0.9 of that of the speed, by 0.04 more each second up to
// 1.34 (recorded loss of a u-blox 7: sAcc 1.7 to 8.9 m/s and pAcc 31 to 177 m in 26 s). A fix after
// more than 10 s begins anew.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "sim/gnss/navigation_filter.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

struct NavigationFix {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
  double clock_m = 0.0;
  double clock_rate_mps = 0.0;
  Eigen::Matrix3d covariance_ned_m2 = Eigen::Matrix3d::Zero();
  double horizontal_sigma_m = 0.0;  ///< Radial.
  double vertical_sigma_m = 0.0;
  double speed_sigma_mps = 0.0;  ///< In space.
  double clock_sigma_m = 0.0;
};

class NavigationEngine {
 public:
  NavigationEngine(const NavigationParameters& parameters, std::size_t satellites)
      : filter_(parameters, satellites) {}

  struct Epoch {
    SimTime time{};  ///< Time of the measurement; not before the last epoch's.
    NavigationTruth truth;
    NavigationNoise noise;
    NavigationCorrelation correlation;
    bool still = false;  ///< The velocity is known to be zero.
  };

  /// Processes an epoch with enough satellites.
  NavigationFix fix(const Epoch& epoch, std::span<const NavigationSignal> signals,
                    const std::optional<NavigationFilter::Position>& position);
  /// Processes an epoch without; returns nothing before the first fix.
  std::optional<NavigationFix> coast(const Epoch& epoch);
  /// Restarts the receiver.
  void forget();
  /// Replaces the last fix by the truth.
  void set(const NavigationTruth& truth) { filter_.set(truth); }

  /// Returns the filter after the last fix.
  [[nodiscard]] const NavigationFilter& filter() const { return filter_; }

 private:
  void predict(const Epoch& epoch, double noise_factor);
  [[nodiscard]] NavigationFix state(const Epoch& epoch) const;

  NavigationFilter filter_;
  SimTime last_ = kNever;   ///< Epoch before.
  SimTime fixed_ = kNever;  ///< Last fix.
  std::optional<NavigationFix> held_;
};

}  // namespace rigwire::sim
