#include "sim/driveline/differential_locks.h"

#include <Eigen/LU>
#include <cmath>
#include <cstddef>

namespace rigwire::sim {
namespace {

/// Unit directions that the locks remove, in the order of Differential.
WheelVector direction(std::size_t lock) {
  constexpr double kHalf = 0.5;
  const double root = std::sqrt(0.5);
  switch (static_cast<Differential>(lock)) {
    case Differential::front:
      return {root, -root, 0.0, 0.0};
    case Differential::centre:
      return {kHalf, kHalf, -kHalf, -kHalf};
    default:
      return {0.0, 0.0, root, -root};
  }
}

/// From the rate along the direction to the difference of two wheels, or of the axles' means.
double difference(std::size_t lock, const WheelVector& rates) {
  const double along = direction(lock).dot(rates);
  return lock == static_cast<std::size_t>(Differential::centre) ? along : along * std::sqrt(2.0);
}

}  // namespace

DifferentialLocks::DifferentialLocks(const AxleParameters& parameters) : parameters_(parameters) {}

void DifferentialLocks::request(const std::array<bool, kDifferentials>& lock) {
  for (std::size_t i = 0; i < kDifferentials; ++i) {
    requested_[i] = lock[i] && parameters_.lockable[i];
  }
}

bool DifferentialLocks::advance(double h, const WheelMatrix& inertia, WheelVector& rates) {
  bool merged = false;
  bool changed = false;
  for (std::size_t i = 0; i < kDifferentials; ++i) {
    if (!requested_[i]) {
      changed = changed || engaged_[i];
      engaged_[i] = false;
      waited_s_[i] = 0.0;
      continue;
    }
    if (engaged_[i]) {
      continue;
    }
    waited_s_[i] += h;
    if (waited_s_[i] < parameters_.lock_time_s - 1e-9 ||
        !(std::abs(difference(i, rates)) <= parameters_.lock_rate_difference_radps)) {
      continue;
    }
    // w' = w - M^-1 c (c.w) / (c.M^-1 c): momentum along everything but the impulse is kept.
    const WheelVector c = direction(i);
    const WheelVector flexibility = inertia.inverse() * c;
    rates -= flexibility * (c.dot(rates) / c.dot(flexibility));
    engaged_[i] = true;
    merged = true;
    changed = true;
  }
  if (changed) {
    make_basis();
    if (merged) {
      rates = basis_.leftCols(coordinates_) * (basis_.leftCols(coordinates_).transpose() * rates);
    }
  }
  return merged;
}

void DifferentialLocks::make_basis() {
  coordinates_ = 0;
  basis_ = WheelMatrix::Identity();
  if (!engaged_[0] && !engaged_[1] && !engaged_[2]) {
    coordinates_ = 4;
    return;
  }
  basis_.col(coordinates_++) = WheelVector::Constant(0.5);
  for (std::size_t i = 0; i < kDifferentials; ++i) {
    if (!engaged_[i]) {
      basis_.col(coordinates_++) = direction(i);
    }
  }
  for (int column = coordinates_; column < 4; ++column) {
    basis_.col(column).setZero();
  }
}

}  // namespace rigwire::sim
