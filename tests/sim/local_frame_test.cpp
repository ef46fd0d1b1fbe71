#include "sim/local_frame.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace rigwire::sim {
namespace {

LocalFrame frame_at(double latitude_deg, double longitude_deg, double height_m) {
  return LocalFrame({latitude_deg, longitude_deg, height_m, 0.0});
}

TEST(LocalFrame, OriginIsWhereTheParametersSay) {
  const LocalFrame frame = frame_at(49.5, 7.75, 280.0);
  const GeodeticPoint point = frame.to_geodetic(Eigen::Vector3d::Zero());
  EXPECT_NEAR(point.latitude_deg, 49.5, 1e-12);
  EXPECT_NEAR(point.longitude_deg, 7.75, 1e-12);
  EXPECT_NEAR(point.ellipsoid_height_m, 280.0, 1e-8);
}

TEST(LocalFrame, ThereAndBackAgainOverAThousandKilometres) {
  const LocalFrame frame = frame_at(-33.9, 151.2, 40.0);
  for (const Eigen::Vector3d& p_W :
       {Eigen::Vector3d(10.0, -20.0, 5.0), Eigen::Vector3d(8e5, 6e5, -4e4)}) {
    EXPECT_LT((frame.to_world(frame.to_geodetic(p_W)) - p_W).norm(), 1e-7);
  }
}

TEST(LocalFrame, EastAcrossTheDateLineIsSmall) {
  const LocalFrame frame = frame_at(-17.0, 179.9999, 0.0);
  const GeodeticPoint point = frame.to_geodetic({100.0, 0.0, 0.0});
  EXPECT_LT(point.longitude_deg, -179.99);
  EXPECT_GE(point.longitude_deg, -180.0);
  EXPECT_NEAR(frame.to_world(point).x(), 100.0, 1e-7);
}

TEST(LocalFrame, PoleHasANorth) {
  const LocalFrame frame = frame_at(90.0, 0.0, 0.0);
  const GeodeticPoint point = frame.to_geodetic({0.0, 0.0, 0.0});
  EXPECT_NEAR(point.latitude_deg, 90.0, 1e-9);
  const Eigen::Matrix3d ned = frame.ned_from_world({0.0, 0.0, 0.0});
  EXPECT_LT((ned * ned.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(LocalFrame, DeadSeaAndEverest) {
  for (const double height_m : {-400.0, 9000.0}) {
    const LocalFrame frame = frame_at(31.5, 35.5, height_m);
    EXPECT_NEAR(frame.to_geodetic({0.0, 0.0, 1.0}).ellipsoid_height_m, height_m + 1.0, 1e-8);
  }
}

TEST(LocalFrame, NorthEastDownAtTheOriginAndTurnedAway) {
  const LocalFrame frame = frame_at(0.0, 0.0, 0.0);
  const Eigen::Vector3d up = frame.ned_from_world({0, 0, 0}) * Eigen::Vector3d(0, 0, 1);
  EXPECT_LT((up - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
  // 111.3 km east along the equator, up has turned by one degree to the east.
  const Eigen::Vector3d away =
      frame.ned_from_world(frame.to_world({0.0, 1.0, 0.0})) * Eigen::Vector3d(0, 0, 1);
  EXPECT_NEAR(away.y(), -0.017452, 1e-6);
  EXPECT_NEAR(away.x(), 0.0, 1e-12);
}

TEST(LocalFrame, RefusesPlacesThatAreNotOnEarth) {
  EXPECT_THROW(frame_at(90.1, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(frame_at(0.0, 181.0, 0.0), std::invalid_argument);
  EXPECT_THROW(frame_at(0.0, 0.0, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
