// REF-18t as its trajectories were published, and how they were driven.
//
// The set: the one that the oracle values were computed with (research table, checked there against
// Simbody and DART). The bucket's lug lies on the line from pin to tip, and the centre of mass on
// its other side; the product's default differs in those two entries, because a bucket pinned that
// way cannot curl under the stick (docs/machines/excavator.md). Drives: k = (2e6 N m/rad, 4.8e7,
// 3e7, 1.9e7 N/m) with damping ratio 0.3, no relief and no end stops.
//
// The scenario: from rest in kPublishedPose, targets that leave their place and return as 1 - cos,
// 4 s. It ends in kSimbodyPose.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "bench/extrapolated_step.h"
#include "sim/excavator/driven_arm.h"

namespace rigwire::bench {

inline sim::ExcavatorParameters published_set() {
  sim::ExcavatorParameters parameters;
  parameters.bucket_linkage.lug_angle_rad = 0.0;
  parameters.bucket.center_of_mass_m = {0.60, 0.0, -0.20};
  parameters.payload_center_of_mass_m = {0.65, 0.0, -0.25};
  parameters.gravity_mps2 = 9.81;
  parameters.initial = {0.0, 0.35, -1.4, 0.6};
  return parameters;
}

inline const Eigen::Vector3d kPublishedGravity{0.0, 0.0, -9.81};
inline const sim::JointVector kPublishedPose(0.0, 0.35, -1.4, 0.6);
/// By Simbody (Merson and CPODES at 1e-10), to nine digits.
inline const sim::JointVector kSimbodyPose(0.736274963, 0.176523521, -1.399930624, 0.357101577);

/// All four drives `factor` times as stiff, their damping ratio kept.
inline sim::DrivenArm published_arm(double factor = 1.0) {
  sim::DrivenArm arm(published_set(), kPublishedGravity);
  arm.gains.stiffness *= factor;
  arm.gains.damping *= std::sqrt(factor);
  return arm;
}

/// Drives that exert nothing.
inline sim::DrivenArm published_free_arm() {
  return published_arm(0.0);
}

struct DriveTargets {
  sim::JointVector position;
  sim::JointVector rate;
};

class CosineTargets {
 public:
  explicit CosineTargets(const sim::DrivenArm& arm) : start_(arm.pose(kPublishedPose).x) {}
  [[nodiscard]] DriveTargets operator()(double time_s) const {
    constexpr std::array<double, 4> kFrequency_hz{0.15, 0.2, 0.25, 0.3};
    constexpr std::array<double, 4> kAmplitude{0.8, -0.35, 0.5, 0.2};
    DriveTargets targets;
    for (int i = 0; i < sim::kArmJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const double w = 2.0 * std::numbers::pi * kFrequency_hz[n];
      targets.position[i] = start_[i] + 0.5 * kAmplitude[n] * (1.0 - std::cos(w * time_s));
      targets.rate[i] = 0.5 * kAmplitude[n] * w * std::sin(w * time_s);
    }
    return targets;
  }

 private:
  sim::JointVector start_;
};

inline DriveTargets no_targets(double /*time_s*/) {
  return {sim::JointVector::Zero(), sim::JointVector::Zero()};
}

/// From time_s on by h > 0, towards targets(time), of that order: 1 is the arm's own step.
template <class Targets>
void step_arm(const sim::DrivenArm& arm, int order, double time_s, double h, const Targets& targets,
              sim::ArmState& state) {
  const Eigen::Matrix<double, 8, 1> end = extrapolated(order, [&](int parts) {
    const double part = h / parts;
    sim::ArmState at = state;
    for (int i = 1; i <= parts; ++i) {
      const DriveTargets there = targets(time_s + i * part);
      const sim::ArmPose pose = arm.pose(at.q_rad);
      arm.advance(part, pose, arm.laws(pose, part, there.position, there.rate), at);
    }
    Eigen::Matrix<double, 8, 1> joined;
    joined << at.q_rad, at.v_radps;
    return joined;
  });
  state = {end.head<4>(), end.tail<4>()};
}

}  // namespace rigwire::bench
