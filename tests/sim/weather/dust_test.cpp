// Dust: masses, growth, drift, and what beams see of it against marching in fine steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "sim/random.h"
#include "sim/weather/dust_cloud.h"
#include "sim/weather/dust_field.h"

namespace rigwire::sim {
namespace {

constexpr double kStep_s = 0.02;

std::vector<DustPuff> random_puffs(int count, std::uint64_t seed, double mass_kg = 0.02) {
  RandomStream stream(seed, "puffs");
  std::vector<DustPuff> puffs;
  for (int i = 0; i < count; ++i) {
    DustPuff puff;
    puff.centre_W = {stream.uniform(5.0, 25.0), stream.uniform(-8.0, 8.0),
                     stream.uniform(0.0, 4.0)};
    puff.mass_kg = mass_kg * stream.uniform(0.2, 2.0);
    puff.variance_m2 = std::pow(stream.uniform(0.25, 2.5), 2);
    puffs.push_back(puff);
  }
  return puffs;
}

/// Extinction of the puffs at a point, from their definition.
double extinction_pm(const std::vector<DustPuff>& puffs, const DustParameters& dust,
                     const Eigen::Vector3d& point_W) {
  double sum = 0.0;
  for (const DustPuff& puff : puffs) {
    const double sigma_m = std::sqrt(puff.variance_m2);
    const double height_m = puff.centre_W.z() - puff.ground_z_m;
    const double above = 0.5 * (1.0 + std::erf(height_m / sigma_m / std::numbers::sqrt2));
    sum += dust.mass_extinction_m2pkg * puff.mass_kg / above /
           std::pow(2.0 * std::numbers::pi * puff.variance_m2, 1.5) *
           std::exp(-(point_W - puff.centre_W).squaredNorm() / (2.0 * puff.variance_m2));
  }
  return sum;
}

WeatherBeam random_beam(RandomStream& stream, double far_m) {
  WeatherBeam beam;
  beam.start_W = {stream.uniform(-2.0, 2.0), stream.uniform(-2.0, 2.0), 2.0};
  beam.direction_W =
      Eigen::Vector3d(1.0, stream.uniform(-0.5, 0.5), stream.uniform(-0.15, 0.1)).normalized();
  beam.near_m = 0.9;
  beam.far_m = far_m;
  return beam;
}

TEST(DustCloudTest, WhatIsEmittedIsAirborneSettledOrDispersed) {
  DustParameters parameters;
  parameters.settling_mps = 0.3;
  DustCloud cloud(parameters);
  double given_kg = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double s_m = 6.0 * i * kStep_s;
    const std::vector<DustEmitter> emitters{
        {.position_W = {s_m, 1.0, 0.0}, .mass_rate_kgps = 0.02},
        {.position_W = {s_m, -1.0, 0.0}, .mass_rate_kgps = i % 100 < 50 ? 0.01 : 0.0},
        {.position_W = {0.0, 5.0, 3.0},
         .radius_m = 0.8,
         .mass_rate_kgps = 0.05,
         .height_over_ground_m = 3.0}};
    cloud.advance(kStep_s, {1.0, 2.0}, i < 1500 ? 0.5 : 0.0, emitters);
    if (i < 1500) {
      given_kg += 0.5 * kStep_s * (0.02 + 0.05 + (i % 100 < 50 ? 0.01 : 0.0));
    }
    ASSERT_LE(cloud.puffs().size(), kMostPuffs);
  }
  const DustBalance& balance = cloud.balance();
  EXPECT_NEAR(balance.emitted_kg, given_kg, 1e-12);
  EXPECT_NEAR(cloud.airborne_kg() + balance.settled_kg + balance.dispersed_kg, given_kg, 1e-12);
  EXPECT_GT(balance.settled_kg, 0.1 * given_kg);
  EXPECT_GT(cloud.airborne_kg(), 0.0);
}

TEST(DustCloudTest, EverythingSettlesInTheEnd) {
  DustParameters parameters;
  parameters.settling_mps = 0.5;
  parameters.diffusivity_m2ps = 0.0;
  DustCloud cloud(parameters);
  const DustEmitter emitter{
      .position_W = {0, 0, 2.0}, .mass_rate_kgps = 1.0, .height_over_ground_m = 2.0};
  cloud.advance(kStep_s, {0, 0}, 1.0, {&emitter, 1});
  for (int i = 0; i < 2000; ++i) {
    cloud.advance(kStep_s, {0, 0}, 0.0, {&emitter, 1});
  }
  EXPECT_NEAR(cloud.balance().settled_kg + cloud.balance().dispersed_kg, kStep_s, 1e-12);
  EXPECT_GT(cloud.balance().settled_kg, 0.99 * kStep_s);
}

TEST(DustCloudTest, APuffGrowsWithTheRootOfTimeAndDriftsWithTheWind) {
  DustParameters parameters;
  parameters.settling_mps = 0.0;
  parameters.diffusivity_m2ps = 0.7;
  DustCloud cloud(parameters);
  const DustEmitter emitter{.position_W = {1.0, 2.0, 3.0}, .radius_m = 1.0, .mass_rate_kgps = 5.0};
  cloud.advance(kStep_s, {0, 0}, 1.0, {&emitter, 1});
  for (int i = 0; i < 500; ++i) {
    cloud.advance(kStep_s, {3.0, -1.0}, 1.0, {});
  }
  ASSERT_EQ(cloud.puffs().size(), 1U);
  EXPECT_TRUE(cloud.puffs()[0].centre_W.isApprox(Eigen::Vector3d(31.0, -8.0, 3.0), 1e-12));
  EXPECT_NEAR(cloud.puffs()[0].variance_m2, 0.25 + 2.0 * 0.7 * 10.0, 1e-9);
}

TEST(DustCloudTest, AUnionKeepsMassCentreAndSecondMoment) {
  const auto puffs = random_puffs(2, 3);
  const DustPuff one = merged(puffs[0], puffs[1]);
  const auto moment = [](const DustPuff& puff) {
    return puff.mass_kg * (puff.centre_W.squaredNorm() + 3.0 * puff.variance_m2);
  };
  EXPECT_NEAR(one.mass_kg, puffs[0].mass_kg + puffs[1].mass_kg, 1e-15);
  EXPECT_TRUE(
      (one.mass_kg * one.centre_W)
          .isApprox(puffs[0].mass_kg * puffs[0].centre_W + puffs[1].mass_kg * puffs[1].centre_W,
                    1e-12));
  EXPECT_NEAR(moment(one), moment(puffs[0]) + moment(puffs[1]), 1e-12);
}

TEST(DustCloudTest, BadEmittersAreLeftOut) {
  DustCloud cloud(DustParameters{});
  const double nan = std::nan("");
  const std::vector<DustEmitter> emitters{
      {.mass_rate_kgps = nan},
      {.mass_rate_kgps = -1.0},
      {.mass_rate_kgps = std::numeric_limits<double>::infinity()},
      {.position_W = {nan, 0, 0}, .mass_rate_kgps = 1.0},
      {.mass_rate_kgps = 0.0}};
  cloud.advance(kStep_s, {0, 0}, 1.0, emitters);
  EXPECT_TRUE(cloud.puffs().empty());
  EXPECT_EQ(cloud.balance().emitted_kg, 0.0);
}

TEST(DustCloudTest, AFullCloudLooksAsOneOfAnyNumberOfPuffs) {
  // Two emitters drive for 12 s; the reference holds a puff for every step.
  DustParameters parameters;
  parameters.settling_mps = 0.0;
  DustCloud cloud(parameters);
  std::vector<DustPuff> every;
  for (int i = 0; i < 600; ++i) {
    const double s_m = 8.0 * i * kStep_s;
    const std::vector<DustEmitter> emitters{
        {.position_W = {s_m, 1.0, 0.0}, .mass_rate_kgps = 0.02},
        {.position_W = {s_m, -1.0, 0.0}, .mass_rate_kgps = 0.02}};
    cloud.advance(kStep_s, {0.0, 0.5}, 1.0, emitters);
    for (DustPuff& puff : every) {
      puff.variance_m2 += 2.0 * parameters.diffusivity_m2ps * kStep_s;
      puff.centre_W.y() += 0.5 * kStep_s;
    }
    for (const DustEmitter& emitter : emitters) {
      every.push_back({emitter.position_W, 0.0, 0.02 * kStep_s, 0.15 * 0.15});
    }
  }
  EXPECT_LE(cloud.puffs().size(), kMostPuffs);
  DustField field;
  field.fill(cloud.puffs(), WeatherParameters{});
  // Across the trail, as the lidar of a follower sees it.
  for (double x_m = 10.0; x_m < 92.0; x_m += 7.3) {
    double expected = 0.0;
    for (int i = 0; i < 300; ++i) {
      expected += extinction_pm(every, parameters, {x_m, -20.0 + 0.2 * (i + 0.5), 1.0}) * 0.2;
    }
    const double found = field.optical_depth({x_m, -20.0, 1.0}, {0, 1, 0}, 60.0);
    EXPECT_NEAR(found / expected, 1.0, 0.15) << x_m;
  }
}

TEST(DustFieldTest, ThroughTheMiddleOfAPuffIsItsMiddleDepth) {
  const WeatherParameters parameters;
  for (const DustPuff& puff : random_puffs(10, 3)) {
    DustField field;
    field.fill({&puff, 1}, parameters);
    const double found =
        field.optical_depth(puff.centre_W - Eigen::Vector3d(50.0, 0.0, 0.0), {1, 0, 0}, 100.0);
    EXPECT_NEAR(found, middle_depth(puff, parameters.dust), 1.1e-4);
  }
}

TEST(DustFieldTest, OpticalDepthIsThatOfMarching) {
  const auto puffs = random_puffs(150, 1);
  const WeatherParameters parameters;
  DustField field;
  field.fill(puffs, parameters);
  RandomStream stream(2, "beams");
  for (int k = 0; k < 20; ++k) {
    const WeatherBeam beam = random_beam(stream, stream.uniform(3.0, 40.0));
    double expected = 0.0;
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i) {
      const double s_m = beam.far_m * (i + 0.5) / kSteps;
      expected += extinction_pm(puffs, parameters.dust, beam.start_W + s_m * beam.direction_W) *
                  beam.far_m / kSteps;
    }
    // Each puff may lack 1e-4.
    EXPECT_NEAR(field.optical_depth(beam.start_W, beam.direction_W, beam.far_m), expected,
                1e-4 * 150 * 0.2 + 1e-6);
  }
}

/// One echo after another, from the definition in fine steps.
std::vector<AirEcho> march(const std::vector<DustPuff>& puffs, const WeatherParameters& parameters,
                           const WeatherBeam& beam) {
  constexpr double kFine_m = 0.01;
  const auto steps = static_cast<std::size_t>(beam.far_m / kFine_m);
  const auto half = static_cast<std::size_t>(beam.pulse_m / kFine_m);
  std::vector<double> returned(steps, 0.0);
  double tau = 0.0;
  for (std::size_t i = 0; i < steps; ++i) {
    const double s_m = (static_cast<double>(i) + 0.5) * kFine_m;
    const double k_pm =
        extinction_pm(puffs, parameters.dust, beam.start_W + s_m * beam.direction_W);
    tau += 0.5 * k_pm * kFine_m;
    if (s_m > 0.9) {
      returned[i] = std::numbers::pi / parameters.dust.lidar_ratio_sr * k_pm *
                    std::exp(-2.0 * tau) * std::min((s_m - 0.9) / 0.1, 1.0) / (s_m * s_m);
    }
    tau += 0.5 * k_pm * kFine_m;
  }
  std::vector<AirEcho> echoes;
  bool inside = false;
  for (std::size_t i = half; i + half < steps; ++i) {
    const double s_m = (static_cast<double>(i) + 0.5) * kFine_m;
    if (s_m < beam.near_m) {
      continue;
    }
    double energy = 0.0;
    for (std::size_t j = i - half; j <= i + half; ++j) {
      const double u = (static_cast<double>(j) - static_cast<double>(i)) * kFine_m / beam.pulse_m;
      energy += std::pow(std::cos(0.5 * std::numbers::pi * u), 2) * returned[j] * kFine_m;
    }
    if (energy >= beam.detection_energy) {
      if (!inside) {
        echoes.push_back({s_m, energy});
      }
      echoes.back().energy = std::max(echoes.back().energy, energy);
    }
    inside = energy >= beam.detection_energy;
  }
  return echoes;
}

TEST(DustFieldTest, EchoesAreThoseOfFineMarching) {
  const WeatherParameters parameters;
  RandomStream stream(5, "beams");
  int compared = 0;
  for (int k = 0; k < 40; ++k) {
    const auto puffs = random_puffs(12, 100 + static_cast<std::uint64_t>(k), 0.1);
    DustField field;
    field.fill(puffs, parameters);
    WeatherBeam beam = random_beam(stream, 40.0);
    beam.detection_energy = detection_energy(200.0);
    AirPath path;
    field.along(beam, 0.0, 0, path);
    const auto expected = march(puffs, parameters, beam);
    for (const AirEcho& echo : expected) {
      if (echo.energy < 1.05 * beam.detection_energy) {
        continue;  // may be missed
      }
      const auto found = std::span(path.echoes).first(path.echo_count);
      const auto same = std::ranges::min_element(
          found, {}, [&](const AirEcho& other) { return std::abs(other.range_m - echo.range_m); });
      ASSERT_NE(same, found.end());
      EXPECT_NEAR(same->energy / echo.energy, 1.0, echo.range_m < 2.0 ? 0.05 : 0.02);
      EXPECT_NEAR(same->range_m, echo.range_m, 0.05);
      ++compared;
    }
    EXPECT_LE(path.echo_count, expected.size());
  }
  EXPECT_GT(compared, 20);
}

TEST(DustFieldTest, ReturnsFromAThickCloudGatherWithinAMetreOfItsEdge) {
  std::vector<DustPuff> puffs;
  for (int i = 0; i < 100; ++i) {  // a bank 10 m thick, its middle 15 m ahead
    DustPuff puff;
    puff.centre_W = {10.0 + (i % 10), -9.0 + 2.0 * (i / 10), 1.0};
    puff.mass_kg = 0.3;
    puff.variance_m2 = 1.2 * 1.2;
    puffs.push_back(puff);
  }
  DustField field;
  field.fill(puffs, WeatherParameters{});
  double least_m = 1e9;
  double most_m = 0.0;
  RandomStream stream(3, "beams");
  for (int k = 0; k < 2000; ++k) {
    WeatherBeam beam;
    beam.start_W = {0.0, stream.uniform(-6.0, 6.0), stream.uniform(0.6, 1.4)};
    beam.far_m = 60.0;
    AirPath path;
    field.along(beam, 0.0, 0, path);
    ASSERT_GE(path.echo_count, 1U);
    least_m = std::min(least_m, path.echoes[0].range_m);
    most_m = std::max(most_m, path.echoes[0].range_m);
    EXPECT_LT(path.transmission, 1e-6);
  }
  EXPECT_LT(most_m - least_m, 1.0);
  EXPECT_GT(least_m, 5.5);
  EXPECT_LT(most_m, 9.0);
}

TEST(DustFieldTest, TheOtherModelReturnsWithProbabilityOfOpticalDepth) {
  WeatherParameters parameters;
  parameters.dust.echo = DustEchoModel::optical_depth;
  std::vector<DustPuff> puffs(1);
  puffs[0].centre_W = {10.0, 0.0, 50.0};
  puffs[0].variance_m2 = 1.0;
  // Optical depth 0.28 through the middle.
  puffs[0].mass_kg = 0.28 * 2.0 * std::numbers::pi / parameters.dust.mass_extinction_m2pkg;
  DustField field;
  field.fill(puffs, parameters);
  constexpr int kBeams = 100000;
  int dust = 0;
  for (std::uint64_t key = 0; key < kBeams; ++key) {
    WeatherBeam beam;
    beam.start_W = {0.0, 0.0, 50.0};
    beam.far_m = 40.0;
    beam.draw_key = key * 77;
    AirPath path;
    field.along(beam, 0.0, 0, path);
    ASSERT_EQ(path.transmission, path.echo_count > 0 ? 0.0 : 1.0);
    dust += static_cast<int>(path.echo_count);
  }
  EXPECT_NEAR(dust / static_cast<double>(kBeams), 0.4, 3.0 * std::sqrt(0.4 * 0.6 / kBeams));
}

TEST(DustFieldTest, ABeamBesideTheCloudIsUntouched) {
  DustField field;
  field.fill(random_puffs(100, 1), WeatherParameters{});
  WeatherBeam beam;
  beam.direction_W = -Eigen::Vector3d::UnitX();
  beam.start_W = {-15.0, 0.0, 2.0};
  beam.far_m = 100.0;
  AirPath path;
  field.along(beam, 0.0, 0, path);
  EXPECT_EQ(path.transmission, 1.0);
  EXPECT_EQ(path.echo_count, 0U);
}

TEST(DustEmitterTest, FactorsAreThoseOfTheTables) {
  // 14 t, silt 12 %: 4.9 (15.43 / 3)^0.45 lb per mile.
  EXPECT_NEAR(1e3 * road_dust_kgpm(14000.0), 4.9 * std::pow(15.432 / 3.0, 0.45) * 0.28185, 1e-3);
  EXPECT_NEAR(dropped_soil_dust_kgpm3(3.0), 0.0046 * std::pow(3.0, 1.1) / std::pow(2.0, 0.3),
              1e-12);
  EXPECT_EQ(road_dust_kgpm(-5.0), 0.0);
  EXPECT_EQ(dropped_soil_dust_kgpm3(-1.0), 0.0);
}

}  // namespace
}  // namespace rigwire::sim
