// One configuration of the arm with its cosines and sines taken once: relative angles for the
// linkages and the mass matrix, absolute ones for everything that gravity and swing see.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace rigwire::sim {

/// 0 swing, 1 boom, 2 stick, 3 bucket.
inline constexpr int kArmJoints = 4;

/// One number per joint.
using JointVector = Eigen::Vector4d;
using JointMatrix = Eigen::Matrix4d;

struct Turn {
  double cosine = 1.0;
  double sine = 0.0;

  [[nodiscard]] static Turn by(double angle_rad) {
    return {std::cos(angle_rad), std::sin(angle_rad)};
  }
  /// The sum of two angles.
  friend Turn operator+(const Turn& a, const Turn& b) {
    return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
  }
};

struct ArmAngles {
  ArmAngles() = default;
  explicit ArmAngles(const JointVector& q_rad)
      : swing_rad(q_rad[0]),
        joint{Turn::by(q_rad[1]), Turn::by(q_rad[2]), Turn::by(q_rad[3])},
        stick_bucket(joint[1] + joint[2]),
        link{joint[0], joint[0] + joint[1], joint[0] + stick_bucket} {}

  double swing_rad = 0.0;
  std::array<Turn, 3> joint;  ///< Boom, stick and bucket, each against the link before it.
  Turn stick_bucket;          ///< Bucket against the boom.
  std::array<Turn, 3> link;   ///< Boom, stick and bucket against the upper structure.
};

}  // namespace rigwire::sim
