// A drum between the points of its surface: an edge may enter where no point is, and a drum that
// rolls must not sink as one point takes the place of another.
#include "sim/contact/round_side.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace rigwire::sim::test {
namespace {

constexpr double kRadius_m = 0.6;
constexpr double kHalf_m = 0.84;
constexpr double kReach_m = 0.05;

/// Its axle level, turned by `yaw_rad` from north to west, and lifted on its left by `tilt_rad`.
Eigen::Isometry3d drum_at(const Eigen::Vector3d& middle_W, double yaw_rad = 0.0,
                          double tilt_rad = 0.0) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = middle_W;
  X.linear() = (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(tilt_rad - 0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  return X;
}

std::vector<SidePlace> places(const Ground& ground, const Eigen::Isometry3d& X_WS) {
  std::vector<SidePlace> found;
  nearest_on_side(ground, ConvexShape::cylinder(kRadius_m, kHalf_m), X_WS, kReach_m, found);
  return found;
}

/// Along x.
Ground profile(const std::function<double(double)>& height_m) {
  HeightField field;
  field.origin_m = {-5.0, -5.0};
  field.cell_m = 0.1;
  field.columns = field.rows = 101;
  for (std::size_t row = 0; row < field.rows; ++row) {
    for (std::size_t column = 0; column < field.columns; ++column) {
      field.heights_m.push_back(height_m(-5.0 + 0.1 * static_cast<double>(column)));
    }
  }
  return Ground(field, SoilMap{{SoilParameters{}}, {}}, {});
}

TEST(RoundSide, OnAPlaneItIsOneLineAsDeepAsTheAxleIsNear) {
  for (const double slope : {0.0, 0.2, 0.7}) {
    for (const double yaw : {0.0, 0.4, 1.5, 3.0}) {
      // The axle along the slope's contour line, and turned from there about the normal.
      const Eigen::Vector3d normal(-std::sin(slope), 0.0, std::cos(slope));
      const Ground ground = Ground::plane(normal, SoilParameters{});
      Eigen::Isometry3d X = drum_at(0.59 * normal);
      X.linear() = Eigen::AngleAxisd(yaw, normal).toRotationMatrix() * X.linear();
      const std::vector<SidePlace> found = places(ground, X);
      ASSERT_EQ(found.size(), 3U) << slope << ' ' << yaw;
      for (const SidePlace& place : found) {
        EXPECT_NEAR(place.gap_m, -0.01, 5e-5);
        EXPECT_LT((place.normal_W - normal).norm(), 1e-12);
        EXPECT_NEAR(place.p_W.dot(normal), -0.01, 5e-5);
      }
    }
  }
}

TEST(RoundSide, TiltedItsLowerRimIsDeepest) {
  const Ground ground = Ground::plane(Eigen::Vector3d::UnitZ(), SoilParameters{});
  for (const double tilt : {0.05, 0.3}) {
    const double lowest_m = kRadius_m * std::cos(tilt) + kHalf_m * std::sin(tilt);
    const std::vector<SidePlace> found =
        places(ground, drum_at({0.0, 0.0, lowest_m - 0.01}, 0.0, tilt));
    ASSERT_FALSE(found.empty());
    const auto deepest = std::ranges::min_element(found, {}, &SidePlace::gap_m);
    EXPECT_NEAR(deepest->gap_m, -0.01, 5e-5);
    EXPECT_LT(deepest->p_W.y(), -0.5);
  }
}

TEST(RoundSide, OverAnEdgeTheNormalIsTheCirclesOwn) {
  // Level up to x = 0, and a face of 78 degrees from there.
  const Ground ground = profile([](double x) { return x > 0.05 ? -0.5 : 0.0; });
  const Eigen::Vector2d edge(0.0, 0.0);
  for (double beyond_m = 0.02; beyond_m < 0.5; beyond_m += 0.013) {
    // Distance from the edge at which 5 mm of it are inside.
    const double apart_m = kRadius_m - 5e-3;
    const Eigen::Vector2d axle(beyond_m, std::sqrt(apart_m * apart_m - beyond_m * beyond_m));
    const std::vector<SidePlace> found = places(ground, drum_at({axle.x(), 0.3, axle.y()}));
    ASSERT_EQ(found.size(), 3U) << beyond_m;
    const Eigen::Vector2d upright = (axle - edge).normalized();
    for (const SidePlace& place : found) {
      EXPECT_NEAR(place.gap_m, -5e-3, 5e-4) << beyond_m;
      EXPECT_NEAR(place.normal_W.x(), upright.x(), 0.02) << beyond_m;
      EXPECT_NEAR(place.normal_W.z(), upright.y(), 0.02) << beyond_m;
    }
  }
}

TEST(RoundSide, InACornerThereAreTwoLines) {
  const Ground ground = profile([](double x) { return x > 0.05 ? 1.0 : 0.0; });
  const double face_m = -kRadius_m * std::hypot(1.0, 0.1) + 0.1 * kRadius_m;  // Touches it there.
  const std::vector<SidePlace> found = places(ground, drum_at({face_m, 0.0, kRadius_m}));
  ASSERT_EQ(found.size(), 6U);
  const auto ahead = std::ranges::count_if(
      found, [](const SidePlace& place) { return place.normal_W.x() < -0.9; });
  EXPECT_EQ(ahead, 3);
  for (const SidePlace& place : found) {
    EXPECT_NEAR(place.gap_m, 0.0, 5e-3);
  }
}

TEST(RoundSide, BeyondReachThereIsNone) {
  const Ground ground = Ground::plane(Eigen::Vector3d::UnitZ(), SoilParameters{});
  EXPECT_TRUE(places(ground, drum_at({0.0, 0.0, kRadius_m + 2.0 * kReach_m})).empty());
}

}  // namespace
}  // namespace rigwire::sim::test
