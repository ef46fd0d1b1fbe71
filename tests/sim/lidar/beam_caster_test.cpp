#include "sim/lidar/beam_caster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "allocation_counter.h"
#include "beam_head.h"
#include "rough_surface.h"

namespace rigwire::sim {
namespace {

using namespace beam_test;

struct EdgeEcho {
  double energy = 0.0;
  double range_m = 0.0;
  double reflectivity = 0.0;
};

/// The part of the beam that looks left (or right) of the azimuth `edge_rad` and meets the upright
/// plane at x there, by the definition.
EdgeEcho plane_part(const LidarPattern& pattern, int count, double edge_rad, bool left, double x,
                    double reflectance) {
  EdgeEcho sum;
  for (const SubRay& ray : sample_beam(pattern.beam, count)) {
    if ((ray.right_rad < edge_rad) != left) {
      continue;
    }
    // Tangents, because the sub-ray's place is in a plane across the beam.
    const double stretch = std::hypot(1.0, std::tan(ray.right_rad), std::tan(ray.up_rad));
    const double range_m = x * stretch;
    const double energy = ray.weight * reflectance / stretch / (range_m * range_m);
    sum.energy += energy;
    sum.range_m += energy * range_m;
    sum.reflectivity += energy * range_m * range_m;
  }
  sum.range_m /= sum.energy;
  return sum;
}

TEST(BeamCaster, AnEdgeBeforeAWallIsOneMixedEchoWithinHalfAPulseAndTwoBeyond) {
  constexpr double kNear_m = 20.0;
  constexpr double kEdge_rad = 1e-4;
  const LidarPattern pattern = head();
  for (const int count : {5, 19}) {
    for (const double gap_m : {0.3, 0.74, 1.1, 5.0}) {
      Scene scene;
      add_board(scene, kNear_m, -kNear_m * std::tan(kEdge_rad), 5.0, paint(0.3));
      add_board(scene, kNear_m + gap_m, -5.0, 5.0, paint(0.8));
      Shooter shooter(exact(count), pattern);
      const LidarFiring firing = shooter.shoot(scene).at(0);
      const EdgeEcho edge = plane_part(pattern, count, kEdge_rad, true, kNear_m, 0.3);
      const EdgeEcho wall = plane_part(pattern, count, kEdge_rad, false, kNear_m + gap_m, 0.8);
      ASSERT_TRUE(firing.several);
      if (gap_m < kHalfPulse_m) {
        const double mixed_m =
            (edge.energy * edge.range_m + wall.energy * wall.range_m) / (edge.energy + wall.energy);
        EXPECT_NEAR(firing.strongest[0].range_m, mixed_m, 1e-4) << count << " " << gap_m;
        EXPECT_NEAR(firing.strongest[0].reflectivity, edge.reflectivity + wall.reflectivity, 1e-4);
        EXPECT_EQ(firing.last[0], firing.strongest[0]);
        EXPECT_EQ(firing.second[0], LidarReturn{});
      } else {
        const bool edge_is_stronger = edge.energy > wall.energy;
        const LidarReturn& of_edge = edge_is_stronger ? firing.strongest[0] : firing.second[0];
        const LidarReturn& of_wall = edge_is_stronger ? firing.second[0] : firing.strongest[0];
        EXPECT_NEAR(of_edge.range_m, edge.range_m, 1e-4) << count << " " << gap_m;
        EXPECT_NEAR(of_edge.reflectivity, edge.reflectivity, 1e-4);
        EXPECT_NEAR(of_wall.range_m, wall.range_m, 1e-4);
        EXPECT_NEAR(of_wall.reflectivity, wall.reflectivity, 1e-4);
        EXPECT_EQ(firing.last[0], of_wall);
      }
    }
  }
}

TEST(BeamCaster, APoleBeforeAWallComesFirstOrLastByItsColour) {
  for (const bool bright_pole : {true, false}) {
    Scene scene;
    add_board(scene, 10.0, -0.006, 0.006, paint(bright_pole ? 0.9 : 0.1));
    add_board(scene, 15.0, -5.0, 5.0, paint(bright_pole ? 0.2 : 0.9));
    Shooter shooter(exact(19), head());
    const LidarFiring firing = shooter.shoot(scene).at(0);
    EXPECT_NEAR(firing.strongest[0].range_m, bright_pole ? 10.0 : 15.0, 1e-3);
    EXPECT_NEAR(firing.second[0].range_m, bright_pole ? 15.0 : 10.0, 1e-3);
    EXPECT_NEAR(firing.last[0].range_m, 15.0, 1e-3);
  }
}

TEST(BeamCaster, WhereEchoesAreNotToldApartThereIsTheStrongestAlone) {
  Scene scene;
  add_board(scene, 10.0, -0.01, 0.01, paint(0.9));
  add_board(scene, 15.0, -5.0, 5.0, paint(0.2));
  Shooter shooter(exact(19), head(), 0.0, false);
  const LidarFiring firing = shooter.shoot(scene).at(0);
  EXPECT_FALSE(firing.several);
  EXPECT_NEAR(firing.strongest[0].range_m, 10.0, 1e-3);
}

TEST(BeamCaster, WhereEchoesAreToldApartABeamHasWidthByItself) {
  Scene scene;
  add_board(scene, 10.0, 0.0003, 5.0, paint(0.9));
  add_board(scene, 40.0, -9.0, 9.0, paint(0.9));
  SpinningLidarParameters parameters;
  parameters.range_sigma_m = 0.0;
  EXPECT_EQ(parameters.sub_rays, 0);
  Shooter both(parameters, head());
  const LidarFiring firing = both.shoot(scene).at(0);
  EXPECT_TRUE(firing.several);
  EXPECT_NEAR(firing.last[0].range_m, 40.0F, 0.01F);
  EXPECT_NEAR(firing.strongest[0].range_m == firing.last[0].range_m ? firing.second[0].range_m
                                                                    : firing.strongest[0].range_m,
              10.0F, 0.01F);
  EXPECT_EQ(both.lidar().rays(), 5U);
  Shooter strongest(parameters, head(), 0.0, false);
  (void)strongest.shoot(scene);
  EXPECT_EQ(strongest.lidar().rays(), 1U);
}

TEST(BeamCaster, OneEchoIsLastAndStrongestToTheLastBit) {
  SpinningLidarParameters parameters;  // with noise
  parameters.sub_rays = 5;
  parameters.range_noise = RangeNoise::signal;
  Scene scene;
  add_board(scene, 15.0, -5.0, 5.0, paint(0.5));
  Shooter shooter(parameters, head());
  for (const LidarFiring& firing : shooter.shoot(scene, 100)) {
    EXPECT_GT(firing.strongest[0].range_m, 0.0F);
    EXPECT_EQ(firing.last[0], firing.strongest[0]);
    EXPECT_EQ(firing.second[0], LidarReturn{});
  }
}

TEST(BeamCaster, SubRaysOfOneSurfaceGiveBackAllOfThePulse) {
  for (const int count : {1, 5, 19, 1000}) {
    Scene scene;
    add_board(scene, 20.0, -5.0, 5.0, paint(0.6));
    Shooter shooter(exact(count), head());
    const LidarReturn echo = shooter.shoot(scene).at(0).strongest[0];
    EXPECT_NEAR(echo.reflectivity, 0.6F, 1e-5) << count;
    EXPECT_NEAR(echo.range_m, 20.0F, 2e-4) << count;
  }
}

TEST(BeamCaster, AThinWireReturnsItsShareOfTheBeamOnTheAverageOverAllPlaces) {
  // A wire swept across the beam: whatever the weights, they sum to 1, and so the mean share is the
  // wire's width over the sweep. One ray sees it seldom and then whole; 19 nearly always.
  constexpr double kRange_m = 20.0;
  constexpr double kWire_m = 0.006;
  constexpr double kSweep_m = 0.2;
  constexpr int kPlaces = 400;
  struct Case {
    int sub_rays;
    double least_seen;  // of the places within half the half angle
  };
  for (const Case& one : {Case{1, 0.0}, Case{19, 0.99}, Case{1000, 0.99}}) {
    double share = 0.0;
    int in_the_middle = 0;
    int seen_in_the_middle = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const double y = kSweep_m * ((i + 0.5) / kPlaces - 0.5);
      Scene scene;
      add_board(scene, kRange_m, y - 0.5 * kWire_m, y + 0.5 * kWire_m, paint(0.8));
      Shooter shooter(exact(one.sub_rays), head());
      const LidarReturn echo = shooter.shoot(scene).at(0).strongest[0];
      share += static_cast<double>(echo.reflectivity) / 0.8 / kPlaces;
      if (std::abs(y) < 0.5 * 1.5e-3 * kRange_m) {
        ++in_the_middle;
        seen_in_the_middle += echo.range_m > 0.0F ? 1 : 0;
      }
    }
    EXPECT_NEAR(share, kWire_m / kSweep_m, 0.02 * kWire_m / kSweep_m) << one.sub_rays;
    EXPECT_GE(seen_in_the_middle, one.least_seen * in_the_middle) << one.sub_rays;
  }
}

TEST(BeamCaster, ATwigBesideTheMiddleIsSeenAgainstTheSky) {
  Scene scene;
  add_board(scene, 20.0, 0.012, 0.022, paint(0.8));  // 0.6 to 1.1 mrad off
  EXPECT_EQ(Shooter(exact(1), head()).shoot(scene).at(0).strongest[0].range_m, 0.0F);
  Shooter wide(exact(19), head());
  EXPECT_NEAR(wide.shoot(scene).at(0).strongest[0].range_m, 20.0, 1e-3);
  EXPECT_EQ(wide.truth()[0][0].range_m, 0.0F);  // the truth is that of the middle
}

TEST(BeamCaster, SlantingGroundIsOneEchoThoughItsPartsLieFarApart) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("ground", {400.0, 40.0, 1.0}));
  scene.add_object(mesh, at(0.0, 0.0, -3.0), 1.0, paint(0.5));  // 2.5 m below the sensor
  LidarPattern pattern = head({-std::atan(2.5 / 70.0)});
  pattern.beam.vertical_divergence_rad = 3e-3;
  for (const int count : {5, 19}) {
    Shooter shooter(exact(count), pattern);
    const LidarFiring firing = shooter.shoot(scene).at(0);
    EXPECT_NEAR(firing.strongest[0].range_m, 70.0, 1.0) << count;
    EXPECT_EQ(firing.second[0], LidarReturn{}) << count;
  }
}

TEST(BeamCaster, ARetroReflectorIsSeenAtThreeTimesTheRangeUnlessItIsTurnedAway) {
  SpinningLidarParameters parameters = exact(5);
  parameters.reference_range_m = 50.0;
  LidarPattern pattern = head();
  const double diffuse_m = 50.0 * std::sqrt(0.2 / 0.9);
  struct Case {
    double retro_gain;
    double yaw_rad;
    float range_m;
    float reflectivity;
  };
  const auto board_m = static_cast<float>(3.0 * diffuse_m);
  for (const Case& one : {Case{0.0, 0.0, 0.0F, 0.0F}, Case{0.5, 0.0, board_m, 1.5F},
                          Case{1.0, 0.3, board_m, 2.0F}, Case{1.0, 0.7, 0.0F, 0.0F}}) {
    Scene scene;
    const auto mesh = scene.add_mesh(make_box("sheet", {1e-4, 4.0, 4.0}));
    scene.add_object(mesh, at(3.0 * diffuse_m, 0.0, 0.0, one.yaw_rad), 1.0,
                     paint(0.2, one.retro_gain));
    const LidarReturn echo = Shooter(parameters, pattern).shoot(scene).at(0).strongest[0];
    EXPECT_NEAR(echo.range_m, one.range_m, 0.01) << one.retro_gain << " " << one.yaw_rad;
    EXPECT_NEAR(echo.reflectivity, one.reflectivity, 0.002);
  }
}

TEST(BeamCaster, OneRayInClearAirSeesRetroReflectorsLikeBeamsDo) {
  Scene scene;
  add_board(scene, 90.0, -1.0, 1.0, paint(0.05, 0.25));
  SpinningLidarParameters parameters;
  parameters.range_sigma_m = 0.0;
  const LidarReturn echo = Shooter(parameters, head()).shoot(scene).at(0).strongest[0];
  EXPECT_FLOAT_EQ(echo.range_m, 90.0F);
  EXPECT_NEAR(echo.reflectivity, 1.25F, 1e-3);
}

TEST(BeamCaster, OneRayWithoutWidthIsTheSameShotWhoeverCastsIt) {
  SpinningLidarParameters quick;
  SpinningLidarParameters beams;
  beams.reference_range_m = 100.0;  // the pattern's own, said aloud: takes the way of the beams
  Scene scene;
  add_board(scene, 30.0, -40.0, 40.0, paint(0.7));
  const LidarPattern pattern = head({-0.2, 0.0, 0.1});
  Shooter one(quick, pattern, 60.0, false);
  Shooter other(beams, pattern, 60.0, false);
  const std::vector<LidarFiring> firings = one.shoot(scene, 300);
  const std::vector<LidarFiring>& again = other.shoot(scene, 300);
  int seen = 0;
  for (std::size_t i = 0; i < firings.size(); ++i) {
    for (std::size_t j = 0; j < pattern.lasers.size(); ++j) {
      EXPECT_FLOAT_EQ(firings[i].strongest[j].range_m, again[i].strongest[j].range_m);
      EXPECT_FLOAT_EQ(firings[i].strongest[j].reflectivity, again[i].strongest[j].reflectivity);
      EXPECT_EQ(one.truth()[i][j].range_m, other.truth()[i][j].range_m);
      EXPECT_EQ(one.truth()[i][j].instance, other.truth()[i][j].instance);
      seen += again[i].strongest[j].range_m > 0.0F ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 100);
}

TEST(BeamCaster, BloomingLetsNeighboursOfARetroReflectorSeeItsRange) {
  Scene scene;
  add_board(scene, 20.0, -0.1, 0.1, paint(0.2, 1.0));
  SpinningLidarParameters parameters = exact(5);
  parameters.reference_range_m = 0.0;
  const double elevation_rad = 0.0;
  LidarPattern pattern = head({elevation_rad});
  pattern.lasers[0].azimuth_offset_rad = 0.010;  // 5 beam widths off the sheet's middle
  EXPECT_EQ(Shooter(parameters, pattern).shoot(scene).at(0).strongest[0].range_m, 0.0F);
  parameters.blooming_share = 1e-3;
  EXPECT_NEAR(Shooter(parameters, pattern).shoot(scene).at(0).strongest[0].range_m, 20.0, 0.01);
  // A white board does not bloom, and a beam on the sheet is not changed by it.
  Scene white;
  add_board(white, 20.0, -0.1, 0.1, paint(1.0));
  EXPECT_EQ(Shooter(parameters, pattern).shoot(white).at(0).strongest[0].range_m, 0.0F);
}

TEST(BeamCaster, TheReflectivityOfASlantingBoardIsItsOwnWhereTheAngleIsCompensated) {
  for (const bool compensates : {false, true}) {
    SpinningLidarParameters parameters = exact(5);
    parameters.compensates_incidence = compensates;
    Scene scene;
    const auto mesh = scene.add_mesh(make_box("board", {1e-4, 4.0, 4.0}));
    scene.add_object(mesh, at(20.0, 0.0, 0.0, std::numbers::pi / 3.0), 1.0, paint(0.8));
    const LidarReturn echo = Shooter(parameters, head()).shoot(scene).at(0).strongest[0];
    EXPECT_NEAR(echo.reflectivity, compensates ? 0.8 : 0.8 * rough_surface(0.5), 2e-3);
  }
}

TEST(BeamCaster, NeitherThreadsNorSlicesChangeAShot) {
  SpinningLidarParameters parameters;
  parameters.sub_rays = 19;
  parameters.range_noise = RangeNoise::signal;
  parameters.laser_bias_sigma_m = 0.02;
  parameters.drop_rate = 0.1;
  Scene scene;
  add_board(scene, 12.0, -0.5, 0.5, paint(0.9));
  add_board(scene, 20.0, -30.0, 30.0, paint(0.4));
  const LidarPattern pattern = head({-0.1, 0.0, 0.05, 0.1});
  Shooter whole(parameters, pattern, 60.0);
  const std::vector<LidarFiring> firings = whole.shoot(scene, 400);
  parameters.threads = 3;
  Shooter threaded(parameters, pattern, 60.0);
  const std::vector<LidarFiring>& same = threaded.shoot(scene, 400);
  Shooter sliced(parameters, pattern, 60.0);
  std::vector<LidarFiring> slices;
  for (int i = 0; i < 8; ++i) {
    const std::vector<LidarFiring>& slice = sliced.shoot(scene, 50);
    slices.insert(slices.end(), slice.begin(), slice.end());
  }
  ASSERT_EQ(slices.size(), firings.size());
  for (std::size_t i = 0; i < firings.size(); ++i) {
    for (std::size_t j = 0; j < pattern.lasers.size(); ++j) {
      EXPECT_EQ(firings[i].strongest[j], same[i].strongest[j]);
      EXPECT_EQ(firings[i].last[j], same[i].last[j]);
      EXPECT_EQ(firings[i].second[j], same[i].second[j]);
      EXPECT_NEAR(firings[i].strongest[j].range_m, slices[i].strongest[j].range_m, 1e-4);
      EXPECT_NEAR(firings[i].last[j].range_m, slices[i].last[j].range_m, 1e-4);
    }
  }
}

TEST(BeamCaster, LanesLeftOverDoNotOverwriteTheLastShotOfTheirPacket) {
  Scene scene;
  add_board(scene, 30.0, -40.0, 40.0, paint(0.7));
  const LidarPattern pattern = head();  // one laser: 3 firings leave 5 lanes over
  for (const int count : {1, 5}) {
    Shooter whole(exact(count), pattern, 60.0);
    const std::vector<LidarFiring> firings = whole.shoot(scene, 8);
    Shooter parts(exact(count), pattern, 60.0);
    for (std::size_t i = 0; i < firings.size(); ++i) {
      const std::vector<LidarFiring>& one = parts.shoot(scene, 1);
      EXPECT_NEAR(one.at(0).strongest[0].range_m, firings[i].strongest[0].range_m, 1e-4);
    }
    Shooter triples(exact(count), pattern, 60.0);
    const std::vector<LidarFiring>& three = triples.shoot(scene, 3);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(three[i].strongest[0].range_m, firings[i].strongest[0].range_m, 1e-4);
    }
  }
}

TEST(BeamCaster, CastingDoesNotAllocate) {
  Scene scene;
  add_board(scene, 12.0, -0.5, 0.5, paint(0.9));
  add_board(scene, 20.0, -30.0, 30.0, paint(0.4));
  SpinningLidarParameters parameters = exact(19);
  parameters.range_noise = RangeNoise::signal;
  parameters.blooming_share = 1e-3;
  Shooter shooter(parameters, head({-0.1, 0.0, 0.1}), 60.0);
  scene.begin_slice(kStart, kStart + 400 * kFiringPeriod, Eigen::Vector3d::Zero(), {});
  std::vector<LidarFiring> firings;
  SimTime time = kStart;
  std::uint64_t allocations = 0;
  for (int i = 0; i < 4; ++i) {
    const SimTime end = time + 100 * kFiringPeriod;
    const std::uint64_t before = rigwire::test::allocations();
    shooter.lidar().cast(scene, {time, end, {}, {}}, nullptr, firings, nullptr);
    allocations =
        rigwire::test::allocations() - before;  // of the last one: the vectors have their length
    time = end;
  }
  EXPECT_EQ(allocations, 0U);
}

TEST(BeamCaster, AReflectanceThatIsNoNumberIsRefusedAtSetUp) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("board", {1.0, 1.0, 1.0}));
  EXPECT_THROW(scene.add_object(mesh, at(5.0, 0.0, 0.0), 1.0,
                                paint(std::numeric_limits<double>::quiet_NaN())),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
