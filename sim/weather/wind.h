// The wind: a mean from the course of the weather, and gusts.
//
// Each horizontal component of the gusts is a first-order Gauss-Markov process with standard
// deviation intensity x mean speed, stepped exactly (the discretisation of sim/gnss/gauss_markov.h
// holds for any step). One wind for the whole scene; no profile over height, no lee of obstacles.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sim/random.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::sim {

/// East and north components of a wind of that speed from that direction (clockwise from north).
[[nodiscard]] Eigen::Vector2d wind_from(double speed_mps, double from_rad);

class Wind {
 public:
  Wind(const WindParameters& parameters, std::uint64_t seed);

  /// `step_s` later, with that mean at its end.
  void advance(double step_s, const Eigen::Vector2d& mean_mps);

  [[nodiscard]] Eigen::Vector2d velocity_mps() const { return velocity_mps_; }

 private:
  WindParameters parameters_;
  RandomStream stream_;
  Eigen::Vector2d gust_ = Eigen::Vector2d::Zero();  ///< In standard deviations.
  Eigen::Vector2d velocity_mps_ = Eigen::Vector2d::Zero();
};

}  // namespace rigwire::sim
