#include "sim/vehicle/velocity_system.h"

#include <utility>

namespace rigwire::sim {
namespace {

using Matrix = std::array<std::array<double, kVelocities>, kVelocities>;

/// Column k of L D L^T. Bounds known to the compiler, which unrolls.
template <std::size_t k>
void eliminate(Matrix& matrix, std::array<double, kVelocities>& diagonal_inverse) {
  const double inverse = 1.0 / matrix[k][k];
  diagonal_inverse[k] = inverse;
  std::array<double, kVelocities> column;
  for (std::size_t i = k + 1; i < kVelocities; ++i) {
    column[i] = matrix[i][k];
  }
  for (std::size_t i = k + 1; i < kVelocities; ++i) {
    const double factor = column[i] * inverse;
    matrix[i][k] = factor;
    for (std::size_t j = k + 1; j <= i; ++j) {
      matrix[i][j] -= factor * column[j];
    }
  }
}

template <std::size_t... k>
void eliminate_all(Matrix& matrix, std::array<double, kVelocities>& diagonal_inverse,
                   std::index_sequence<k...>) {
  (eliminate<k>(matrix, diagonal_inverse), ...);
}

}  // namespace

void VelocitySystem::add_body(const VelocityRow& row, double weight, double impulse) {
  for (std::size_t i = 0; i < kBodyVelocities; ++i) {
    const double scaled = weight * row.value[i];
    for (std::size_t j = 0; j <= i; ++j) {
      matrix[i][j] += scaled * row.value[j];
    }
    right[i] += impulse * row.value[i];
  }
}

void VelocitySystem::add_without_wheel(const VelocityRow& row, double weight, double impulse) {
  add_body(row, weight, impulse);
  const std::size_t s = kBodyVelocities + 2 * row.axle;
  const double first = weight * row.value[6];
  const double second = weight * row.value[7];
  for (std::size_t j = 0; j < kBodyVelocities; ++j) {
    matrix[s][j] += first * row.value[j];
    matrix[s + 1][j] += second * row.value[j];
  }
  matrix[s][s] += first * row.value[6];
  matrix[s + 1][s] += second * row.value[6];
  matrix[s + 1][s + 1] += second * row.value[7];
  right[s] += impulse * row.value[6];
  right[s + 1] += impulse * row.value[7];
}

void VelocitySystem::add(const VelocityRow& row, double weight, double impulse) {
  add_without_wheel(row, weight, impulse);
  const std::size_t s = kBodyVelocities + 2 * row.axle;
  const std::size_t w = kWheelVelocity + row.wheel;
  const double scaled = weight * row.value[8];
  for (std::size_t j = 0; j < kBodyVelocities; ++j) {
    matrix[w][j] += scaled * row.value[j];
  }
  matrix[w][s] += scaled * row.value[6];
  matrix[w][s + 1] += scaled * row.value[7];
  matrix[w][w] += scaled * row.value[8];
  right[w] += impulse * row.value[8];
}

void VelocitySystem::add_impulse(const VelocityRow& row, double impulse) {
  const std::size_t s = kBodyVelocities + 2 * row.axle;
  for (std::size_t i = 0; i < kBodyVelocities; ++i) {
    right[i] += impulse * row.value[i];
  }
  right[s] += impulse * row.value[6];
  right[s + 1] += impulse * row.value[7];
  right[kWheelVelocity + row.wheel] += impulse * row.value[8];
}

Velocities VelocitySystem::times(const Velocities& v) const {
  Velocities product{};
  for (std::size_t i = 0; i < kVelocities; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      product[i] += matrix[i][j] * v[j];
      product[j] += matrix[i][j] * v[i];
    }
    product[i] += matrix[i][i] * v[i];
  }
  return product;
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
  constexpr std::size_t n = kVelocities;
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

  std::array<double, n> diagonal_inverse;
  eliminate_all(matrix, diagonal_inverse, std::make_index_sequence<n>());
  Velocities x = right;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) {
      x[i] -= matrix[i][k] * x[k];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    x[i] *= diagonal_inverse[i];
  }
  for (std::size_t i = n; i-- > 1;) {
    for (std::size_t j = 0; j < i; ++j) {
      x[j] -= matrix[i][j] * x[i];
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
