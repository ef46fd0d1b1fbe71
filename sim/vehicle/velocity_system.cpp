#include "sim/vehicle/velocity_system.h"

#include <utility>

namespace rigwire::sim {
namespace {

using Matrix = std::array<std::array<double, kVelocities>, kVelocities>;

/// row[0 .. n] -= factor other[0 .. n] with n made odd: pairs fit the registers, and what is
/// written beyond the diagonal is never read. Bounds known to the compiler, which unrolls.
template <std::size_t n>
void subtract(double* row, double factor, const double* other) {
  for (std::size_t j = 0; j <= (n | 1U); ++j) {
    row[j] -= factor * other[j];
  }
}

/// Unknown k out of the equations of those before it; leaves row k of U^T and 1 / D.
template <std::size_t k, std::size_t... i>
void eliminate(Matrix& matrix, Velocities& x, std::index_sequence<i...>) {
  const double inverse = 1.0 / matrix[k][k];
  Velocities factor;
  for (std::size_t j = 0; j < k; ++j) {
    factor[j] = matrix[k][j] * inverse;
    x[j] -= factor[j] * x[k];
  }
  (subtract<i>(matrix[i].data(), factor[i], matrix[k].data()), ...);
  for (std::size_t j = 0; j < k; ++j) {
    matrix[k][j] = factor[j];
  }
  x[k] *= inverse;
}

/// From the last to the first: the wheels, with the fewest couplings, are eliminated first.
template <std::size_t... back>
void eliminate_all(Matrix& matrix, Velocities& x, std::index_sequence<back...>) {
  (eliminate<kVelocities - 1 - back>(matrix, x, std::make_index_sequence<kVelocities - 1 - back>()),
   ...);
}

/// target[0 .. n] += factor row[0 .. n], n made odd.
template <std::size_t... i>
void add_triangle(Matrix& matrix, const double* row, double weight, std::index_sequence<i...>) {
  (subtract<i>(matrix[i].data(), -weight * row[i], row), ...);
}

}  // namespace

void VelocitySystem::add_body(const VelocityRow& row, double weight, double impulse) {
  const auto value = row.value;  // Nothing else points at it: the loops need not look.
  add_triangle(matrix, value.data(), weight, std::make_index_sequence<kBodyVelocities>());
  for (std::size_t i = 0; i < kBodyVelocities; ++i) {
    right[i] += impulse * value[i];
  }
}

void VelocitySystem::add_without_wheel(const VelocityRow& row, double weight, double impulse) {
  add_body(row, weight, impulse);
  const auto value = row.value;
  const std::size_t s = kBodyVelocities + 2 * row.axle;
  const double first = weight * value[6];
  const double second = weight * value[7];
  double* const first_row = matrix[s].data();
  double* const second_row = matrix[s + 1].data();
  for (std::size_t j = 0; j < kBodyVelocities; ++j) {
    first_row[j] += first * value[j];
    second_row[j] += second * value[j];
  }
  first_row[s] += first * value[6];
  second_row[s] += second * value[6];
  second_row[s + 1] += second * value[7];
  right[s] += impulse * value[6];
  right[s + 1] += impulse * value[7];
}

void VelocitySystem::add(const VelocityRow& row, double weight, double impulse) {
  add_without_wheel(row, weight, impulse);
  const auto value = row.value;
  const std::size_t s = kBodyVelocities + 2 * row.axle;
  const std::size_t w = kWheelVelocity + row.wheel;
  const double scaled = weight * value[8];
  double* const wheel_row = matrix[w].data();
  for (std::size_t j = 0; j < kBodyVelocities; ++j) {
    wheel_row[j] += scaled * value[j];
  }
  wheel_row[s] += scaled * value[6];
  wheel_row[s + 1] += scaled * value[7];
  wheel_row[w] += scaled * value[8];
  right[w] += impulse * value[8];
}

void VelocitySystem::add_wheels(const WheelMatrix& weights, const WheelVector& impulses) {
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      matrix[kWheelVelocity + i][kWheelVelocity + j] +=
          weights(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
    right[kWheelVelocity + i] += impulses[static_cast<Eigen::Index>(i)];
  }
}

Velocities VelocitySystem::solve(const WheelMatrix& basis, int coordinates) {
  const bool restricted = coordinates < 4;
  if (restricted) {
    // Rows of the wheels become rows of the coordinates; those without get the identity.
    Eigen::Matrix<double, 4, 10> side;
    WheelMatrix block;
    WheelVector force;
    for (Eigen::Index i = 0; i < 4; ++i) {
      const auto row = kWheelVelocity + static_cast<std::size_t>(i);
      for (Eigen::Index j = 0; j < 10; ++j) {
        side(i, j) = matrix[row][static_cast<std::size_t>(j)];
      }
      for (Eigen::Index j = 0; j <= i; ++j) {
        block(i, j) = matrix[row][kWheelVelocity + static_cast<std::size_t>(j)];
        block(j, i) = block(i, j);
      }
      force[i] = right[row];
    }
    // Congruence with T = basis: T^T A T and T^T b, locked directions out.
    const Eigen::Matrix<double, 4, 10> new_side = basis.transpose() * side;
    const WheelMatrix new_block = basis.transpose() * block * basis;
    const WheelVector new_force = basis.transpose() * force;
    for (Eigen::Index i = 0; i < 4; ++i) {
      const auto row = kWheelVelocity + static_cast<std::size_t>(i);
      const bool free = i < coordinates;
      for (Eigen::Index j = 0; j < 10; ++j) {
        matrix[row][static_cast<std::size_t>(j)] = free ? new_side(i, j) : 0.0;
      }
      for (Eigen::Index j = 0; j <= i; ++j) {
        matrix[row][kWheelVelocity + static_cast<std::size_t>(j)] =
            free ? new_block(i, j) : (i == j ? 1.0 : 0.0);
      }
      right[row] = free ? new_force[i] : 0.0;
    }
  }

  // A = U D U^T from the last unknown up, x = D^-1 U^-1 b on the way; then U^T forwards.
  Velocities x = right;
  eliminate_all(matrix, x, std::make_index_sequence<kVelocities>());
  for (std::size_t i = 1; i < kVelocities; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      x[i] -= matrix[i][j] * x[j];
    }
  }

  if (restricted) {
    const Eigen::Map<const WheelVector> reduced(&x[kWheelVelocity]);
    const WheelVector rates = basis.leftCols(coordinates) * reduced.head(coordinates);
    for (std::size_t i = 0; i < 4; ++i) {
      x[kWheelVelocity + i] = rates[static_cast<Eigen::Index>(i)];
    }
  }
  return x;
}

}  // namespace rigwire::sim
