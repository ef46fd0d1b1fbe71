// Position error from range errors: the weighted least squares that a receiver solves, linearised
// at the true antenna position.
//
//   dx = K eps,   K = (G^T W G)^-1 G^T W,   G rows [-e, 1 in the clock column of the system]
//
// The weights W see each range's sigma alone; the covariance K R K^T knows which parts of the
// errors R are common to the satellites.
//
// The linearisation leaves out dx^2 / (2 range): 2 um for 10 m, 0.2 mm for 100 m of error.
// Satellites of SBAS and QZSS keep GPS time and share its clock column; every other system has its
// own, and a system of one satellite alone says nothing about the position.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sim/gnss/dilution.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::sim {

/// Errors that all satellites share: see RangeEquation::common_m.
inline constexpr std::size_t kCommonErrors = 4;

/// One pseudorange of the solution.
struct RangeEquation {
  Eigen::Vector3d direction_ned = -Eigen::Vector3d::UnitZ();  ///< Unit, antenna to satellite.
  GnssSystem system = GnssSystem::gps;
  double error_m = 0.0;  ///< Measured less true.
  double sigma_m = 1.0;  ///< Sigma that the receiver assumes, above 0; all parts together.
  /// Parts of sigma_m that the satellites have in common: each the factor of one random number of
  /// variance 1.
  std::array<double, kCommonErrors> common_m{};
};

/// A height that is held because it cannot be solved for.
struct HeldHeight {
  double error_m = 0.0;  ///< Held less true.
  double sigma_m = 0.0;
};

struct PositionSolution {
  Eigen::Vector3d error_ned_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ned_m2 = Eigen::Matrix3d::Zero();  ///< Follows the sigmas alone.
  double clock_error_m = 0.0;  ///< Error of GPS time, or of the first system in the solution.
  double clock_sigma_m = 0.0;
  Dilution dilution;                ///< Unweighted; vertical NaN with a held height.
  std::vector<double> residuals_m;  ///< Per equation: what the solution does not explain.
};

/// Satellites that are left for the position when every system has paid for its clock: 4 and more
/// give a position in 3D, 3 in 2D. Equals the count for one system.
[[nodiscard]] int effective_count(std::span<const RangeEquation> equations);

/// Nothing when the satellites do not determine the position: too few, on a cone or in a plane
/// (condition of G^T W G above 1e10), or position dilution above 100.
[[nodiscard]] std::optional<PositionSolution> solve_position(
    std::span<const RangeEquation> equations, const std::optional<HeldHeight>& held);

}  // namespace rigwire::sim
