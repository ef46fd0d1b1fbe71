// The driven scenario that the published trajectories belong to: four targets that leave their
// place and return as 1 - cos.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "sim/excavator/driven_arm.h"

namespace rigwire::sim {

inline const JointVector kPublishedPose(0.0, 0.35, -1.4, 0.6);

class CosineTargets final : public TargetMotion {
 public:
  explicit CosineTargets(const DrivenArm& arm) : start_(arm.pose(kPublishedPose).x) {}
  void at(double time_s, JointVector& target, JointVector& rate) const override {
    constexpr std::array<double, 4> kFrequency_hz{0.15, 0.2, 0.25, 0.3};
    constexpr std::array<double, 4> kAmplitude{0.8, -0.35, 0.5, 0.2};
    for (int i = 0; i < kArmJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const double w = 2.0 * std::numbers::pi * kFrequency_hz[n];
      target[i] = start_[i] + 0.5 * kAmplitude[n] * (1.0 - std::cos(w * time_s));
      rate[i] = 0.5 * kAmplitude[n] * w * std::sin(w * time_s);
    }
  }

 private:
  JointVector start_;
};

}  // namespace rigwire::sim
