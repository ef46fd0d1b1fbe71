#include "sim/gnss/multipath.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "fake_sky.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kClearance_m = 0.05;
const Eigen::Vector3d kAntenna(0.0, 0.0, 2.0);

TEST(ReflectionSearch, ExtraPathIsThatOfTheMirrorImage) {
  // Wall 12 m to the east; satellites to the west are mirrored by it.
  const FakeWall wall(12.0, 100.0, 100.0);
  ReflectionSearch search({});
  for (const double elevation_deg : {10.0, 35.0, 60.0}) {
    for (const double from_west_deg : {0.0, 30.0, -50.0}) {
      const Eigen::Vector3d s =
          direction((270.0 + from_west_deg) * kDegree, elevation_deg * kDegree);
      const std::array satellites{ReflectionSearch::Satellite{0, s}};
      search = ReflectionSearch({});
      search.update(kStart, kAntenna, satellites, 1, wall, kClearance_m);
      const auto extra_m = search.extra_path_m(0, kAntenna, s);
      ASSERT_TRUE(extra_m) << elevation_deg << " " << from_west_deg;
      EXPECT_NEAR(
          *extra_m,
          2.0 * 12.0 * std::cos(elevation_deg * kDegree) * std::cos(from_west_deg * kDegree), 1e-6);
      // The path follows the antenna towards the wall without a new search.
      const Eigen::Vector3d nearer = kAntenna + Eigen::Vector3d(2.0, 0.0, 0.0);
      EXPECT_NEAR(*search.extra_path_m(0, nearer, s) / *extra_m, 10.0 / 12.0, 1e-9);
    }
  }
}

TEST(ReflectionSearch, WallsThatEndOrAreBehindReflectNothing) {
  const Eigen::Vector3d west = direction(270.0 * kDegree, 45.0 * kDegree);
  const Eigen::Vector3d east = direction(90.0 * kDegree, 45.0 * kDegree);
  const std::array satellites{ReflectionSearch::Satellite{0, west},
                              ReflectionSearch::Satellite{1, east}};
  ReflectionSearch high({});
  high.update(kStart, kAntenna, satellites, 2, FakeWall(12.0, 100.0, 100.0), kClearance_m);
  EXPECT_TRUE(high.extra_path_m(0, kAntenna, west));
  EXPECT_FALSE(high.extra_path_m(1, kAntenna, east)) << "the wall's back is towards it";
  ReflectionSearch low({});
  low.update(kStart, kAntenna, satellites, 2, FakeWall(12.0, 100.0, 8.0), kClearance_m);
  EXPECT_FALSE(low.extra_path_m(0, kAntenna, west)) << "the specular point is 14 m up";
  ReflectionSearch far({});
  far.update(kStart, kAntenna, satellites, 2, FakeWall(60.0, 100.0, 100.0), kClearance_m);
  EXPECT_FALSE(far.extra_path_m(0, kAntenna, west)) << "beyond the reach";
}

TEST(ReflectionSearch, SearchesAgainWhenDue) {
  MultipathParameters parameters;
  parameters.search_distance_m = 2.0;
  parameters.search_period_s = 10.0;
  const FakeWall wall(12.0, 100.0, 100.0);
  const std::array satellites{
      ReflectionSearch::Satellite{0, direction(270.0 * kDegree, 45.0 * kDegree)}};
  ReflectionSearch search(parameters);
  const auto rays_of = [&](Duration t, double y_m) {
    const auto before = search.rays();
    search.update(kStart + t, kAntenna + Eigen::Vector3d(0.0, y_m, 0.0), satellites, 1, wall,
                  kClearance_m);
    return search.rays() - before;
  };
  EXPECT_GE(rays_of(0s, 0.0), 32U);
  EXPECT_EQ(rays_of(1s, 1.0), 0U);
  EXPECT_GE(rays_of(2s, 2.0), 32U) << "2 m on";
  EXPECT_EQ(rays_of(11s, 2.0), 0U);
  EXPECT_GE(rays_of(12s, 2.0), 32U) << "10 s later";
}

TEST(Multipath, EnvelopeRisesToHalfTheCorrelatorSpacingAndEnds) {
  MultipathParameters parameters;
  parameters.reflection_loss_db = 20.0 * std::log10(2.0);  // half the amplitude
  parameters.correlator_spacing_m = 30.0;
  EXPECT_NEAR(multipath_envelope_m(parameters, 4.0), 2.0, 1e-12);
  EXPECT_NEAR(multipath_envelope_m(parameters, 100.0), 7.5, 1e-12);
  EXPECT_EQ(multipath_envelope_m(parameters, 500.0), 0.0);
}

}  // namespace
}  // namespace rigwire::sim
