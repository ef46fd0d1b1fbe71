#include "sim/gnss/position_solution.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kWorstCondition = 1e10;
constexpr double kWorstSolvedDilution = 100.0;
constexpr std::size_t kClocks = 8;  // GnssSystem has values to 6
constexpr int kMostUnknowns = 3 + static_cast<int>(kClocks);

using Square =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostUnknowns, kMostUnknowns>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostUnknowns, 1>;

std::size_t clock_of(GnssSystem system) {
  const bool gps_time = system == GnssSystem::sbas || system == GnssSystem::qzss;
  return static_cast<std::size_t>(gps_time ? GnssSystem::gps : system) % kClocks;
}

/// Column of G for each clock, -1 without a satellite.
struct Columns {
  explicit Columns(std::span<const RangeEquation> equations, bool height_held)
      : first_clock(height_held ? 2 : 3), unknowns(first_clock) {
    of_clock.fill(-1);
    std::array<bool, kClocks> present{};
    for (const RangeEquation& equation : equations) {
      present[clock_of(equation.system)] = true;
    }
    for (std::size_t clock = 0; clock < kClocks; ++clock) {
      if (present[clock]) {
        of_clock[clock] = unknowns++;
      }
    }
  }
  /// Row of G: north, east, (down,) clocks.
  [[nodiscard]] Column row(const RangeEquation& equation) const {
    Column row = Column::Zero(unknowns);
    row.head(first_clock) = -equation.direction_ned.head(first_clock);
    row(of_clock[clock_of(equation.system)]) = 1.0;
    return row;
  }

  std::array<int, kClocks> of_clock{};
  int first_clock;
  int unknowns;
};

std::optional<Square> inverse(const Square& normal) {
  const Eigen::SelfAdjointEigenSolver<Square> solver(normal);
  const auto& values = solver.eigenvalues();
  if (!(values(0) > 0.0) || values(values.size() - 1) / values(0) > kWorstCondition) {
    return std::nullopt;
  }
  return Square(solver.eigenvectors() * values.cwiseInverse().asDiagonal() *
                solver.eigenvectors().transpose());
}

/// K R K^T, R with the ranges' own and common parts.
Square spread(std::span<const RangeEquation> equations, const Columns& columns,
              const Square& inverse_normal) {
  const int n = columns.unknowns;
  Square covariance = Square::Zero(n, n);
  std::array<Column, kCommonErrors> common;
  common.fill(Column::Zero(n));
  for (const RangeEquation& equation : equations) {
    const double variance = equation.sigma_m * equation.sigma_m;
    // Column of K = (G^T W G)^-1 G^T W; R has own variances on its diagonal and common parts c c^T.
    const Column gain = inverse_normal * columns.row(equation) / variance;
    double own_variance = variance;
    for (std::size_t i = 0; i < kCommonErrors; ++i) {
      common[i] += equation.common_m[i] * gain;
      own_variance -= equation.common_m[i] * equation.common_m[i];
    }
    covariance += std::max(own_variance, 0.0) * gain * gain.transpose();
  }
  for (const Column& gain : common) {
    covariance += gain * gain.transpose();
  }
  return covariance;
}

void note_dilution(const Square& q, const Columns& columns, PositionSolution& solution) {
  // Roots of the diagonal of (G^T G)^-1.
  solution.dilution.north = std::sqrt(q(0, 0));
  solution.dilution.east = std::sqrt(q(1, 1));
  solution.dilution.horizontal = std::sqrt(q(0, 0) + q(1, 1));
  solution.dilution.position = solution.dilution.horizontal;
  if (columns.first_clock == 3) {
    solution.dilution.vertical = std::sqrt(q(2, 2));
    solution.dilution.position = std::sqrt(q(0, 0) + q(1, 1) + q(2, 2));
  }
  solution.dilution.time = std::sqrt(q(columns.first_clock, columns.first_clock));
}

}  // namespace

int effective_count(std::span<const RangeEquation> equations) {
  const Columns columns(equations, false);
  const int clocks = columns.unknowns - columns.first_clock;
  return static_cast<int>(equations.size()) - (clocks > 1 ? clocks - 1 : 0);
}

std::optional<PositionSolution> solve_position(std::span<const RangeEquation> equations,
                                               const std::optional<HeldHeight>& held) {
  const Columns columns(equations, held.has_value());
  if (static_cast<int>(equations.size()) < columns.unknowns || equations.empty()) {
    return std::nullopt;
  }
  const int n = columns.unknowns;
  // Down is minus the height. When the height is held, its effect on a range moves to the right
  // side.
  const double held_down_m = held ? -held->error_m : 0.0;
  Square weighted = Square::Zero(n, n);
  Square plain = Square::Zero(n, n);
  Column right = Column::Zero(n);
  Column height = Column::Zero(n);  // of a held height of down = 1
  for (const RangeEquation& equation : equations) {
    const Column row = columns.row(equation);
    const double weight = 1.0 / (equation.sigma_m * equation.sigma_m);
    const double by_height = -equation.direction_ned.z();
    // Normal equations G^T W G x = G^T W eps; G^T G alone for the dilutions.
    weighted += weight * row * row.transpose();
    plain += row * row.transpose();
    right += weight * (equation.error_m - by_height * held_down_m) * row;
    height += weight * by_height * row;
  }
  const auto inverse_normal = inverse(weighted);
  const auto unweighted = inverse(plain);
  if (!inverse_normal || !unweighted) {
    return std::nullopt;
  }
  PositionSolution solution;
  note_dilution(*unweighted, columns, solution);
  if (!(solution.dilution.position <= kWorstSolvedDilution)) {
    return std::nullopt;
  }
  const Column x = *inverse_normal * right;
  const int axes = columns.first_clock;
  Square covariance = spread(equations, columns, *inverse_normal);
  solution.error_ned_m.head(axes) = x.head(axes);
  if (held) {
    const Column gain = *inverse_normal * height;  // minus d x / d down
    const double variance = held->sigma_m * held->sigma_m;
    covariance += variance * gain * gain.transpose();
    solution.error_ned_m.z() = held_down_m;
    solution.covariance_ned_m2.topRightCorner<2, 1>() = -variance * gain.head<2>();
    solution.covariance_ned_m2.bottomLeftCorner<1, 2>() = -variance * gain.head<2>().transpose();
    solution.covariance_ned_m2(2, 2) = variance;
  }
  solution.covariance_ned_m2.topLeftCorner(axes, axes) = covariance.topLeftCorner(axes, axes);
  solution.clock_sigma_m = std::sqrt(covariance(axes, axes));
  solution.clock_error_m = x(axes);
  // Residuals eps - G x.
  solution.residuals_m.reserve(equations.size());
  for (const RangeEquation& equation : equations) {
    solution.residuals_m.push_back(equation.error_m + equation.direction_ned.z() * held_down_m -
                                   columns.row(equation).dot(x));
  }
  return solution;
}

}  // namespace rigwire::sim
