#include "sim/lidar/beam_air.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "beam_head.h"

namespace rigwire::sim {
namespace {

using namespace beam_test;

/// Even extinction along the beam, and echoes at given places.
class FakeAir final : public Weather {
 public:
  double extinction_pm = 0.0;
  std::vector<AirEcho> echoes;
  bool is_present = true;
  mutable std::vector<WeatherBeam> asked;

  [[nodiscard]] AirPath along(const WeatherBeam& beam) const override {
    asked.push_back(beam);
    AirPath path;
    path.transmission = std::exp(-2.0 * extinction_pm * beam.far_m);
    for (const AirEcho& echo : echoes) {
      if (echo.range_m < beam.far_m) {
        path.echoes[path.echo_count++] = echo;
      }
    }
    return path;
  }
  [[nodiscard]] bool present() const override { return is_present; }
};

TEST(BeamAir, ASurfaceReturnsWhatTheAirLetsThroughBothWays) {
  FakeAir air;
  air.extinction_pm = 0.01;
  for (const int count : {1, 5, 19}) {
    Scene scene;
    add_board(scene, 30.0, -5.0, 5.0, paint(0.9));
    Shooter shooter(exact(count), head());
    const LidarReturn echo = shooter.shoot(scene, 1, &air).at(0).strongest[0];
    EXPECT_NEAR(echo.range_m, 30.0F, 1e-3F);
    EXPECT_NEAR(echo.reflectivity, 0.9 * std::exp(-0.6), 1e-4) << count;
  }
}

TEST(BeamAir, FarSensitivityChangesNeitherExtinctionNorWhatIsToldOfTheAir) {
  LidarReturn before;
  for (const double reference_m : {100.0, 150.0, 660.0}) {
    FakeAir air;
    air.extinction_pm = 0.01;
    SpinningLidarParameters parameters = exact(5);
    parameters.reference_range_m = reference_m;
    parameters.air_reference_range_m = 100.0;
    parameters.air_minimum_range_m = 1.5;
    Scene scene;
    add_board(scene, 30.0, -5.0, 5.0, paint(0.9));
    Shooter shooter(parameters, head());
    const LidarReturn echo = shooter.shoot(scene, 1, &air).at(0).strongest[0];
    EXPECT_NEAR(echo.reflectivity, 0.9 * std::exp(-0.6), 1e-4) << reference_m;
    EXPECT_TRUE(before == LidarReturn{} || echo == before) << reference_m;
    before = echo;
    for (const WeatherBeam& beam : air.asked) {
      EXPECT_DOUBLE_EQ(beam.detection_energy, 0.9 / (100.0 * 100.0)) << reference_m;
      EXPECT_EQ(beam.near_m, 1.5);
    }
  }
}

TEST(BeamAir, EdgeAndWallAreWeakenedEachOverItsOwnWay) {
  FakeAir air;
  air.extinction_pm = 0.02;
  Scene scene;
  add_board(scene, 10.0, 0.0003, 5.0, paint(0.9));
  add_board(scene, 40.0, -9.0, 9.0, paint(0.9));
  Shooter clear(exact(19), head());
  const LidarFiring before = clear.shoot(scene).at(0);
  Shooter hazy(exact(19), head());
  const LidarFiring after = hazy.shoot(scene, 1, &air).at(0);
  EXPECT_NEAR(after.strongest[0].reflectivity, before.strongest[0].reflectivity * std::exp(-0.4F),
              1e-4F);
  EXPECT_NEAR(after.last[0].reflectivity, before.last[0].reflectivity * std::exp(-1.6F), 1e-4F);
}

TEST(BeamAir, AnEchoOfTheAirComesFirstAndTheSurfaceLast) {
  FakeAir air;
  air.echoes = {{.range_m = 8.0, .energy = 0.02}};
  Scene scene;
  add_board(scene, 30.0, -5.0, 5.0, paint(0.9));
  Shooter shooter(exact(5), head());
  const LidarFiring firing = shooter.shoot(scene, 1, &air).at(0);
  EXPECT_NEAR(firing.strongest[0].range_m, 8.0F, 1e-4F);  // 0.02 against 0.9 / 900
  EXPECT_NEAR(firing.second[0].range_m, 30.0F, 1e-3F);
  EXPECT_NEAR(firing.last[0].range_m, 30.0F, 1e-3F);
}

TEST(BeamAir, AirBehindAnEdgeReturnsWhatPassesTheEdge) {
  FakeAir air;
  air.echoes = {{.range_m = 20.0, .energy = 0.001}};
  Scene scene;
  add_board(scene, 10.0, -5.0, -0.0003, paint(0.9));
  const LidarPattern pattern = head();
  double passing = 0.0;
  for (const SubRay& ray : sample_beam(pattern.beam, 19)) {
    passing += std::tan(ray.right_rad) < 0.00003 ? ray.weight : 0.0;
  }
  Shooter shooter(exact(19), pattern);
  const LidarFiring firing = shooter.shoot(scene, 1, &air).at(0);
  EXPECT_NEAR(firing.last[0].range_m, 20.0F, 1e-4F);
  EXPECT_NEAR(firing.last[0].reflectivity, passing * 0.001 * 400.0, 1e-5);
}

TEST(BeamAir, TheSameAirIsAskedWithTheBeamAsItIs) {
  FakeAir air;
  Scene scene;
  add_board(scene, 30.0, -5.0, 5.0, paint(0.9));
  Shooter shooter(exact(5), head({0.0, 0.05}));
  shooter.shoot(scene, 3, &air);
  ASSERT_FALSE(air.asked.empty());
  const WeatherBeam& first = air.asked.front();
  EXPECT_NEAR(first.far_m, 30.0, 1e-3);
  EXPECT_NEAR(first.near_m, 1.0, 1e-6);
  EXPECT_NEAR(first.pulse_m, kHalfPulse_m, 1e-6);
  EXPECT_NEAR(first.divergence_rad, std::sqrt(3e-3 * 1.5e-3), 1e-9);
  EXPECT_NEAR(first.direction_W.x(), 1.0, 1e-6);
  EXPECT_NEAR(to_seconds(first.time - kStart), to_seconds(kFiringPeriod), 1e-9);
  for (std::size_t i = 0; i < air.asked.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool same_shot = air.asked[i].time == air.asked[j].time &&
                             air.asked[i].direction_W.isApprox(air.asked[j].direction_W, 1e-5);
      EXPECT_EQ(air.asked[i].draw_key == air.asked[j].draw_key, same_shot);
    }
  }
}

TEST(BeamAir, WhereNothingIsInTheAirNobodyAsks) {
  FakeAir air;
  air.is_present = false;
  Scene scene;
  add_board(scene, 30.0, -5.0, 5.0, paint(0.9));
  Shooter shooter(exact(5), head());
  shooter.shoot(scene, 3, &air);
  EXPECT_TRUE(air.asked.empty());
}

TEST(BeamAir, FogWithoutAnyLightLeftIsDarkAndNotANumber) {
  FakeAir air;
  air.extinction_pm = 100.0;
  Scene scene;
  add_board(scene, 10.0, 0.0, 5.0, paint(0.9));
  add_board(scene, 40.0, -9.0, 9.0, paint(0.9));
  Shooter shooter(exact(19), head());
  const LidarFiring firing = shooter.shoot(scene, 1, &air).at(0);
  EXPECT_EQ(firing.strongest[0], LidarReturn{});
  EXPECT_EQ(firing.last[0], LidarReturn{});
}

}  // namespace
}  // namespace rigwire::sim
