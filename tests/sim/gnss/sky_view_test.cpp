#include "sim/gnss/sky_view.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "fake_sky.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

const Eigen::Vector3d kHere = Eigen::Vector3d::Zero();

SkyViewParameters with(SkySamples samples) {
  SkyViewParameters parameters;
  parameters.samples = samples;
  return parameters;
}

/// Everything east of the meridian is hidden.
const FakeSky kEastHidden([](const Eigen::Vector3d& d) { return d.x() > 0.0; });

TEST(SkyView, HalfTheConeHiddenCostsSixDecibel) {
  const Eigen::Vector3d edge = direction(0.0, 40.0 * kDegree) - Eigen::Vector3d(1e-9, 0.0, 0.0);
  const SkyArrival soft = sky_arrival(with(SkySamples::four), kEastHidden, kHere, edge);
  EXPECT_EQ(soft.rays, 4);
  EXPECT_DOUBLE_EQ(soft.open_share, 0.5);
  const SkyViewParameters parameters;
  const double free_dbhz = direct_cn0_dbhz(parameters, 0.5, SkyArrival{});
  EXPECT_NEAR(direct_cn0_dbhz(parameters, 0.5, soft), free_dbhz - 6.0206, 1e-4);
  const SkyArrival sharp = sky_arrival(with(SkySamples::one), kEastHidden, kHere, edge);
  EXPECT_EQ(sharp.rays, 1);
  EXPECT_DOUBLE_EQ(sharp.open_share, 1.0);
}

// Means of a NEO-M8T on a roof (gpsd's regression tests), bands of 15 degrees. Before: 38 + 10 sin
// E, 10 dB too strong below 15 degrees.
TEST(SkyView, SignalsFallTowardsTheHorizonAsOnARoof) {
  constexpr std::array kRoof_dbhz{24.0, 39.0, 46.0, 48.0, 52.0};
  for (std::size_t i = 0; i < kRoof_dbhz.size(); ++i) {
    const double middle_deg = 7.5 + 15.0 * static_cast<double>(i);
    EXPECT_NEAR(direct_cn0_dbhz({}, std::sin(middle_deg * kDegree), SkyArrival{}), kRoof_dbhz[i],
                1.6)
        << middle_deg;
  }
  const SkyViewParameters parameters;
  EXPECT_DOUBLE_EQ(direct_cn0_dbhz({}, 0.0, SkyArrival{}), parameters.cn0_horizon_dbhz);
  EXPECT_DOUBLE_EQ(direct_cn0_dbhz({}, 1.0, SkyArrival{}), parameters.cn0_zenith_dbhz);
}

TEST(SkyView, SixteenGoOnOnlyNearEdges) {
  const SkyViewParameters parameters = with(SkySamples::sixteen);
  const Eigen::Vector3d edge = direction(0.0, 40.0 * kDegree);
  EXPECT_EQ(sky_arrival(parameters, kEastHidden, kHere, edge).rays, 16);
  const Eigen::Vector3d free = direction(-60.0 * kDegree, 40.0 * kDegree);
  EXPECT_EQ(sky_arrival(parameters, kEastHidden, kHere, free).rays, 4);
  // The share falls steadily across the edge, from all to nothing within the cone.
  double last = 1.0;
  for (double offset_deg = -2.0; offset_deg <= 2.0; offset_deg += 0.25) {
    const Eigen::Vector3d d(std::sin(offset_deg * kDegree), std::cos(offset_deg * kDegree), 0.0);
    const double share = sky_arrival(parameters, kEastHidden, kHere, d).open_share;
    EXPECT_LE(share, last) << offset_deg;
    last = share;
  }
  EXPECT_EQ(last, 0.0);
}

TEST(SkyView, FoliageWeakensByTheMetre) {
  const FakeSky wood([](const Eigen::Vector3d&) { return false; },
                     [](const Eigen::Vector3d&) { return 6.0; });
  SkyViewParameters parameters;
  parameters.foliage_attenuation_dbpm = 1.5;
  const SkyArrival arrival = sky_arrival(parameters, wood, kHere, Eigen::Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(arrival.foliage_m, 6.0);
  EXPECT_NEAR(direct_cn0_dbhz(parameters, 1.0, arrival), parameters.cn0_zenith_dbhz - 9.0, 1e-12);
}

// Before: a ray that missed a crown ten metres away by a hand's breadth lost nothing.
TEST(SkyView, CrownsBesideTheRayTakeTheirPart) {
  // Crowns over everything but a hole of 4 degrees around the zenith.
  const FakeSky hole([](const Eigen::Vector3d&) { return false; },
                     [](const Eigen::Vector3d& d) {
                       return std::acos(std::min(1.0, d.z())) > 4.0 * kDegree ? 6.0 : 0.0;
                     });
  EXPECT_DOUBLE_EQ(sky_arrival({}, hole, kHere, Eigen::Vector3d::UnitZ()).foliage_m, 0.0);
  const SkyArrival near = sky_arrival({}, hole, kHere, Eigen::Vector3d::UnitZ(), true);
  EXPECT_DOUBLE_EQ(near.foliage_m, 3.0);
  EXPECT_DOUBLE_EQ(near.open_share, 1.0);
  EXPECT_EQ(near.rays, 8);
}

TEST(SkyView, LeavesFadeByFiveToEightDecibelUnderCrowns) {
  EXPECT_DOUBLE_EQ(foliage_sigma_db(0.0), 0.0);
  for (const double foliage_db : {4.0, 6.0, 9.0, 15.0, 30.0}) {
    EXPECT_GE(foliage_sigma_db(foliage_db), 5.0) << foliage_db;
    EXPECT_LE(foliage_sigma_db(foliage_db), 8.0) << foliage_db;
  }
}

TEST(SkyView, ABlockedSatelliteHasNoSignal) {
  const FakeSky closed = closed_sky();
  const SkyArrival arrival = sky_arrival({}, closed, kHere, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(direct_cn0_dbhz({}, 1.0, arrival), -std::numeric_limits<double>::infinity());
}

TEST(SatelliteTracker, ReacquiresAfterATimeAndWithHysteresis) {
  SkyViewParameters parameters;
  parameters.cn0_threshold_dbhz = 25.0;
  parameters.cn0_hysteresis_db = 3.0;
  parameters.reacquisition_time_s = 2.0;
  SatelliteTracker tracker;
  const auto at = [&](Duration t, double cn0_dbhz) {
    return tracker.advance(parameters, {.time = kStart + t, .cn0_dbhz = cn0_dbhz});
  };
  EXPECT_TRUE(at(0s, 26.0)) << "in view at the start";
  EXPECT_TRUE(at(1s, 25.0));
  EXPECT_FALSE(at(2s, 24.9));
  EXPECT_FALSE(at(3s, 27.9)) << "below threshold + hysteresis";
  EXPECT_FALSE(at(4s, 28.0));
  EXPECT_FALSE(at(5s, 28.0));
  EXPECT_TRUE(at(6s, 28.0)) << "strong for 2 s";
  EXPECT_EQ(tracker.since(), kStart + 6s);
  EXPECT_TRUE(at(7s, 25.5));
  EXPECT_FALSE(at(8s, 0.0));
  EXPECT_FALSE(at(9s, 40.0));
  EXPECT_FALSE(at(10s, 20.0)) << "the wait begins anew";
  EXPECT_FALSE(at(11s, 40.0));
  EXPECT_FALSE(at(12s, 40.0));
  EXPECT_TRUE(at(13s, 40.0));
}

TEST(SatelliteTracker, WaitsForAChannel) {
  SatelliteTracker tracker;
  EXPECT_FALSE(tracker.advance({}, {.time = kStart, .cn0_dbhz = 45.0, .channel_free = false}));
  EXPECT_TRUE(tracker.advance({}, {.time = kStart + 5s, .cn0_dbhz = 45.0}));
  EXPECT_TRUE(tracker.advance({}, {.time = kStart + 6s, .cn0_dbhz = 45.0, .channel_free = false}));
}

TEST(SkyView, RefusesStrangeParameters) {
  SkyViewParameters parameters;
  parameters.maximum_channels = 185;
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  parameters = {};
  parameters.foliage_attenuation_dbpm = std::nan("");
  EXPECT_THROW(validate(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
