// Planes and polylines of field programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "field/geometry.h"
#include "path_follow/path_file.h"

namespace rigwire::field {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<PlanePosition> circle(double radius_m, int points) {
  std::vector<PlanePosition> ring;
  for (int i = 0; i < points; ++i) {
    const double a = 2.0 * std::numbers::pi * i / points;
    ring.push_back({radius_m * std::cos(a), radius_m * std::sin(a)});
  }
  return ring;
}

TEST(FieldLocalPlane, EqualsTheEllipsoidNearTheReference) {
  const LocalPlane plane({49.4247, 7.7517});
  // Lengths of a degree by their series in the latitude (NIMA TR8350.2): of the meridian
  // 111132.92 - 559.82 cos 2f + 1.175 cos 4f, of the parallel 111412.84 cos f - 93.5 cos 3f
  // + 0.118 cos 5f.
  const double f = 49.4252 * kDegree;
  const PlanePosition p = plane.to_plane({49.4257, 7.7527});
  EXPECT_NEAR(p.north_m,
              1e-3 * (111132.92 - 559.82 * std::cos(2.0 * f) + 1.175 * std::cos(4.0 * f)), 1e-3);
  EXPECT_NEAR(
      p.east_m,
      1e-3 * (111412.84 * std::cos(f) - 93.5 * std::cos(3.0 * f) + 0.118 * std::cos(5.0 * f)),
      2e-3);
  const LatLon back = plane.to_geodetic({-831.0, 412.0});
  const PlanePosition again = plane.to_plane(back);
  EXPECT_NEAR(again.east_m, -831.0, 1e-6);
  EXPECT_NEAR(again.north_m, 412.0, 1e-6);
}

TEST(FieldAngle, CompassAndMathematicalTurnIntoEachOther) {
  EXPECT_NEAR(turned_compass(0.0), 90 * kDegree, 1e-12);
  EXPECT_NEAR(turned_compass(90 * kDegree), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(turned_compass(270 * kDegree)), 180 * kDegree, 1e-12);
  EXPECT_NEAR(turned_compass(turned_compass(0.3)), 0.3, 1e-12);
}

TEST(FieldPolyline, PlaceDirectionAndCurvatureOfACircle) {
  const Polyline path(circle(25.0, 360), true);
  EXPECT_NEAR(path.length_m(), 50.0 * std::numbers::pi, 0.01);
  for (const double along : {0.5, 40.0, 120.0, path.length_m() - 0.5}) {
    const double a = along / 25.0;
    EXPECT_NEAR(wrapped(path.direction_rad(along) - a - 0.5 * std::numbers::pi), 0.0, 0.01);
    EXPECT_NEAR(path.curvature_1pm(along), 0.04, 0.003);
    const auto place = path.nearest({27.0 * std::cos(a), 27.0 * std::sin(a)});
    EXPECT_NEAR(place.along_m, along, 0.05);
    EXPECT_NEAR(place.offset_m, -2.0, 0.01) << "right of the path";
  }
}

TEST(FieldPolyline, NearAWindowOnlyThatBranchCounts) {
  // Out and back, 1 m beside itself.
  const Polyline path({{0, 0}, {50, 0}, {50, 1}, {0, 1}}, false);
  EXPECT_NEAR(path.nearest({20, 0.9}).along_m, 81.0, 1e-9);
  EXPECT_NEAR(path.nearest({20, 0.9}, 19.0, 8.0).along_m, 20.0, 1e-9);
  const PlanePosition beyond = path.at(path.length_m() + 3.0);
  EXPECT_NEAR(beyond.east_m, -3.0, 1e-9);
}

TEST(FieldPolyline, RefusesWhatIsNoPath) {
  EXPECT_THROW(Polyline({{0, 0}}, false), std::invalid_argument);
  EXPECT_THROW(Polyline({{0, 0}, {1, 0}}, true), std::invalid_argument);
  EXPECT_THROW(Polyline({{0, 0}, {0, 0}}, false), std::invalid_argument);
  EXPECT_THROW(Polyline({{0, 0}, {std::nan(""), 0}}, false), std::invalid_argument);
}

TEST(PathFollowFile, ReadsPointsCommentsAndClosed) {
  const auto path =
      path_follow::parse_path("# loop\n49.1, 7.5\r\n49.2,7.6\n\nclosed\n49.3,7.7", "loop.csv");
  EXPECT_TRUE(path.closed);
  ASSERT_EQ(path.points.size(), 3U);
  EXPECT_EQ(path.points[1].longitude_deg, 7.6);
}

TEST(PathFollowFile, SaysWhereItIsWrong) {
  EXPECT_THAT([] { (void)path_follow::parse_path("49.1,7.5\n49.2;7.6\n", "loop.csv"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("loop.csv:2: found '49.2;7.6'")));
  EXPECT_THAT([] { (void)path_follow::parse_path("91,7.5\n", "loop.csv"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("loop.csv:1")));
  EXPECT_THAT([] { (void)path_follow::parse_path("49,7.5\n", "loop.csv"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("has 1 points")));
}

}  // namespace
}  // namespace rigwire::field
