// What the ground does to the bucket: a given force, and resistances that the arm's own solve
// finds.
//
// A resistance is a force along a line through one point of the bucket, linear in that point's
// velocity u along the line at the end of the step and bounded:
//
//     F = offset - gain u,   |F| <= limit
//
// gain enters the left-hand side of the arm's velocity solve, so that stiff soil costs no smaller
// step; the limit is tested after the solve (clamp last). A passive soil has offset 0, the gain of
// a very stiff damper and the failure force of the soil as limit: the bucket stops in it unless its
// drives push harder than it fails.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace rigwire::sim {

/// How many resistances act at once: along the cut, into the ground, and across.
inline constexpr std::size_t kTipResistances = 4;

/// One resistance against the bucket.
struct TipResistance {
  Eigen::Vector3d direction_W = Eigen::Vector3d::UnitX();  ///< Unit; F and u count along it.
  double offset_n = 0.0;
  double gain_nspm = 0.0;                             ///< >= 0.
  double limit_n = 0.0;                               ///< >= 0.
  Eigen::Vector3d point_B = Eigen::Vector3d::Zero();  ///< In the bucket's frame, m.
};

/// Everything from outside on the bucket during a step.
struct BucketLoad {
  Eigen::Vector3d force_W = Eigen::Vector3d::Zero();  ///< N, on the bucket.
  Eigen::Vector3d point_B = Eigen::Vector3d::Zero();  ///< Where it acts, in the bucket's frame.
  std::array<TipResistance, kTipResistances> resistances;
  std::size_t resistance_count = 0;

  [[nodiscard]] bool empty() const { return resistance_count == 0 && force_W.isZero(0.0); }
};

}  // namespace rigwire::sim
