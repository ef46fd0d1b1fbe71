// The arm's linear system: four unknowns, symmetric, positive definite.
#pragma once

#include "sim/excavator/arm_dynamics.h"

namespace rigwire::sim {

/// x of m x = right by L D L^T, unrolled: about a third of what a general factorisation of this
/// size costs. Only the lower half of m is read.
inline JointVector solve_joints(const JointMatrix& m, const JointVector& right) {
  const double d0 = 1.0 / m(0, 0);
  const double l10 = m(1, 0) * d0;
  const double l20 = m(2, 0) * d0;
  const double l30 = m(3, 0) * d0;
  const double d1 = 1.0 / (m(1, 1) - l10 * m(1, 0));
  const double u21 = m(2, 1) - l20 * m(1, 0);
  const double u31 = m(3, 1) - l30 * m(1, 0);
  const double l21 = u21 * d1;
  const double l31 = u31 * d1;
  const double d2 = 1.0 / (m(2, 2) - l20 * m(2, 0) - l21 * u21);
  const double u32 = m(3, 2) - l30 * m(2, 0) - l31 * u21;
  const double l32 = u32 * d2;
  const double d3 = 1.0 / (m(3, 3) - l30 * m(3, 0) - l31 * u31 - l32 * u32);
  const double y0 = right[0];
  const double y1 = right[1] - l10 * y0;
  const double y2 = right[2] - l20 * y0 - l21 * y1;
  const double y3 = right[3] - l30 * y0 - l31 * y1 - l32 * y2;
  const double x3 = y3 * d3;
  const double x2 = y2 * d2 - l32 * x3;
  const double x1 = y1 * d1 - l21 * x2 - l31 * x3;
  return {y0 * d0 - l10 * x1 - l20 * x2 - l30 * x3, x1, x2, x3};
}

}  // namespace rigwire::sim
