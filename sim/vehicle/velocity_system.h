// The linear system of one step of the full vehicle: 14 velocities, one symmetric positive definite
// matrix, built from rank-1 terms and solved by U D U^T. Fixed size, no allocation.
//
// Order of the unknowns: body's velocity 0 .. 2 and rate 3 .. 5 (axes of B), suspension of the
// front axle 6, 7 and of the rear axle 8, 9, wheel rates 10 .. 13.
//
// A force F = offset - gain u along u = J v adds h gain J^T J to the matrix and
// h (offset - gain u_start) J^T to the right-hand side for the change of velocities.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "sim/driveline/driveline.h"

namespace rigwire::sim {

inline constexpr std::size_t kBodyVelocities = 6;
inline constexpr std::size_t kWheelVelocity = 10;
inline constexpr std::size_t kVelocities = 14;
using Velocities = std::array<double, kVelocities>;

/// One row J: body, the two coordinates of one axle, one wheel.
struct VelocityRow {
  alignas(16) std::array<double, 9> value{};  ///< 6 body, 2 suspension, 1 wheel.
  std::size_t axle = 0;                       ///< 0 front, 1 rear.
  std::size_t wheel = 0;                      ///< 0 .. 3.

  [[nodiscard]] double of(const Velocities& v) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kBodyVelocities; ++i) {
      sum += value[i] * v[i];
    }
    const std::size_t s = kBodyVelocities + 2 * axle;
    return sum + value[6] * v[s] + value[7] * v[s + 1] + value[8] * v[kWheelVelocity + wheel];
  }
};

class VelocitySystem {
 public:
  /// Lower triangle; row i, column j <= i. Elements above it are meaningless.
  alignas(16) std::array<std::array<double, kVelocities>, kVelocities> matrix{};
  Velocities right{};

  /// matrix += weight J^T J, right += impulse J^T.
  void add(const VelocityRow& row, double weight, double impulse);
  /// Adds a row without wheel.
  void add_without_wheel(const VelocityRow& row, double weight, double impulse);
  /// Adds a row with body velocities only.
  void add_body(const VelocityRow& row, double weight, double impulse);
  /// Adds the equations of the wheels' coupling: matrix += weights, right += impulses.
  void add_wheels(const WheelMatrix& weights, const WheelVector& impulses);

  /// Returns the change of the velocities, wheel rates restricted to basis.leftCols(coordinates).
  /// Destroys matrix and right.
  [[nodiscard]] Velocities solve(const WheelMatrix& basis, int coordinates);
};

}  // namespace rigwire::sim
