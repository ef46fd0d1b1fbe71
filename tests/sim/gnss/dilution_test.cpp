#include "sim/gnss/dilution.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace rigwire::sim {
namespace {

// Values of Eq. 1 and Table 1 worked out by hand: n, HDOP, VDOP, PDOP.
TEST(RegressionDilution, IsTheTableOfThePaper) {
  struct Row {
    int n;
    double h, v, p;
  };
  constexpr std::array rows{
      Row{2, 4.09, 7.56, 2.47},  Row{3, 3.49, 6.50, 2.39},  Row{4, 2.99, 5.58, 2.31},
      Row{5, 2.55, 4.79, 2.24},  Row{6, 2.18, 4.12, 2.17},  Row{7, 1.86, 3.53, 2.10},
      Row{8, 1.59, 3.04, 2.03},  Row{9, 1.36, 2.61, 1.97},  Row{10, 1.16, 2.24, 1.90},
      Row{11, 1.02, 1.92, 1.84}, Row{12, 1.02, 1.65, 1.78}, Row{13, 1.02, 1.42, 1.73},
      Row{14, 1.02, 1.22, 1.67},
  };
  for (const Row& row : rows) {
    EXPECT_DOUBLE_EQ(kHorizontalRegression.rounded(row.n), row.h) << row.n;
    EXPECT_DOUBLE_EQ(kVerticalRegression.rounded(row.n), row.v) << row.n;
    EXPECT_DOUBLE_EQ(kPositionRegression.rounded(row.n), row.p) << row.n;
  }
}

TEST(RegressionDilution, AmplitudeIsNeitherRoundedNorClamped) {
  const auto model = make_regression_dilution();
  const std::vector<Eigen::Vector3d> twelve(12, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(model->amplitude(twelve).horizontal, 0.85068, 1e-5);
  EXPECT_DOUBLE_EQ(model->reported(twelve).horizontal, 1.02);
  const std::vector<Eigen::Vector3d> two(2, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(std::isnan(model->reported(two).horizontal));
}

std::vector<Eigen::Vector3d> zenith_and_ring(int n, double elevation_deg) {
  std::vector<Eigen::Vector3d> directions{Eigen::Vector3d::UnitZ()};
  const double elevation = elevation_deg * std::numbers::pi / 180.0;
  for (int i = 0; i < n; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / n + 0.3;
    directions.emplace_back(std::cos(elevation) * std::sin(azimuth),
                            std::cos(elevation) * std::cos(azimuth), std::sin(elevation));
  }
  return directions;
}

TEST(GeometricDilution, ZenithAndRingHaveAClosedForm) {
  const auto model = make_geometric_dilution();
  for (const int n : {3, 4, 7}) {
    for (const double elevation_deg : {0.0, 5.0, 15.0, 30.0}) {
      const auto directions = zenith_and_ring(n, elevation_deg);
      const double s = std::sin(elevation_deg * std::numbers::pi / 180.0);
      const double horizontal2 = 4.0 / (n * (1.0 - s * s));
      const double vertical2 = (n + 1.0) / (n * (1.0 - s) * (1.0 - s));
      const Dilution dilution = model->reported(directions);
      EXPECT_NEAR(dilution.horizontal, std::sqrt(horizontal2), 1e-9);
      EXPECT_NEAR(dilution.vertical, std::sqrt(vertical2), 1e-9);
      EXPECT_NEAR(dilution.position, std::sqrt(horizontal2 + vertical2), 1e-9);
    }
  }
  const Dilution flat = model->reported(zenith_and_ring(3, 0.0));
  EXPECT_NEAR(std::hypot(flat.position, flat.time), 1.7321, 5e-5);  // geometric dilution
}

TEST(GeometricDilution, ThreeSatellitesHoldTheHeight) {
  const auto model = make_geometric_dilution();
  auto ring = zenith_and_ring(3, 0.0);
  ring.erase(ring.begin());
  const Dilution dilution = model->reported(ring);
  EXPECT_NEAR(dilution.horizontal, std::sqrt(4.0 / 3.0), 1e-9);
  EXPECT_TRUE(std::isnan(dilution.vertical));
}

TEST(GeometricDilution, ConeHasNoSolution) {
  const auto model = make_geometric_dilution();
  auto ring = zenith_and_ring(6, 40.0);
  ring.erase(ring.begin());
  EXPECT_TRUE(std::isnan(model->reported(ring).horizontal));
  EXPECT_TRUE(std::isnan(model->reported({}).horizontal));
}

}  // namespace
}  // namespace rigwire::sim
