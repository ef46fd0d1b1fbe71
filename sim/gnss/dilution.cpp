#include "sim/gnss/dilution.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kSmallestDilution = 1.02;
constexpr double kTimeToHorizontal = 0.8;
constexpr double kWorstCondition = 1e10;

class RegressionDilution final : public DilutionModel {
 public:
  Dilution reported(std::span<const Eigen::Vector3d> directions_W) const override {
    const int n = static_cast<int>(directions_W.size());
    if (n < 3) {
      return {};
    }
    const double horizontal = kHorizontalRegression.rounded(n);
    return {.horizontal = horizontal,
            .vertical = kVerticalRegression.rounded(n),
            .position = kPositionRegression.rounded(n),
            .time = horizontal * kTimeToHorizontal};
  }
  Dilution amplitude(std::span<const Eigen::Vector3d> directions_W) const override {
    const int n = static_cast<int>(directions_W.size());
    if (n < 3) {
      return {};
    }
    const double horizontal = kHorizontalRegression.raw(n);
    return {.horizontal = horizontal,
            .vertical = kVerticalRegression.raw(n),
            .position = kPositionRegression.raw(n),
            .time = horizontal * kTimeToHorizontal};
  }
};

/// Diagonal of (G^T G)^-1; NaN when it does not exist.
template <int kUnknowns>
Eigen::Matrix<double, kUnknowns, 1> variances(
    const Eigen::Matrix<double, kUnknowns, kUnknowns>& normal) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kUnknowns, kUnknowns>> solver(normal);
  const auto& values = solver.eigenvalues();
  if (!(values(0) > 0.0) || values(kUnknowns - 1) / values(0) > kWorstCondition) {
    return Eigen::Matrix<double, kUnknowns, 1>::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return (solver.eigenvectors() * values.cwiseInverse().asDiagonal() *
          solver.eigenvectors().transpose())
      .diagonal();
}

class GeometricDilution final : public DilutionModel {
 public:
  Dilution reported(std::span<const Eigen::Vector3d> directions_W) const override {
    Dilution dilution;
    if (directions_W.size() == 3) {
      // Height held: columns east, north, clock.
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      for (const auto& e : directions_W) {
        const Eigen::Vector3d row(-e.x(), -e.y(), 1.0);
        normal += row * row.transpose();
      }
      const Eigen::Vector3d q = variances<3>(normal);
      dilution.horizontal = std::sqrt(q(0) + q(1));
      dilution.east = std::sqrt(q(0));
      dilution.north = std::sqrt(q(1));
      dilution.position = dilution.horizontal;
      dilution.time = std::sqrt(q(2));
    } else if (directions_W.size() > 3) {
      // G^T G of rows (-e, 1): columns east, north, up, clock.
      Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
      for (const auto& e : directions_W) {
        const Eigen::Vector4d row(-e.x(), -e.y(), -e.z(), 1.0);
        normal += row * row.transpose();
      }
      const Eigen::Vector4d q = variances<4>(normal);
      dilution.horizontal = std::sqrt(q(0) + q(1));
      dilution.east = std::sqrt(q(0));
      dilution.north = std::sqrt(q(1));
      dilution.vertical = std::sqrt(q(2));
      dilution.position = std::sqrt(q(0) + q(1) + q(2));
      dilution.time = std::sqrt(q(3));
    }
    return dilution;
  }
  Dilution amplitude(std::span<const Eigen::Vector3d> directions_W) const override {
    return reported(directions_W);
  }
};

}  // namespace

double RegressionTerm::raw(int satellites) const {
  // Eq. 1 of Wolf et al. 2020 without rounding and clamp.
  return a * std::pow(rn, satellites);
}

double RegressionTerm::rounded(int satellites) const {
  return std::max(std::floor(raw(satellites) * 100.0 + 0.5) / 100.0, kSmallestDilution);
}

std::unique_ptr<DilutionModel> make_regression_dilution() {
  return std::make_unique<RegressionDilution>();
}

std::unique_ptr<DilutionModel> make_geometric_dilution() {
  return std::make_unique<GeometricDilution>();
}

std::unique_ptr<DilutionModel> make_dilution(DilutionKind kind) {
  return kind == DilutionKind::regression ? make_regression_dilution() : make_geometric_dilution();
}

}  // namespace rigwire::sim
