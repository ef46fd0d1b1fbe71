// Fog and haze against an integration in time written here, as the paper prints it.
#include "sim/weather/droplets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "sim/lidar/counter_noise.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::sim {
namespace {

constexpr double kLight_mpns = 0.299792458;

/// Mean power from range R, middle of a pulse sin^2(pi t / 2 tau), 0 <= t <= 2 tau, in an even fog
/// of beta = 1: Hahner's integral over time with light's own way in metres, and a lens that takes
/// (s / focus)^2 of what is nearer than its focus.
double received(double range_m, double alpha_pm, double tau_ns, double focus_m) {
  constexpr int kSteps = 1500;
  const double step_ns = 2.0 * tau_ns / kSteps;
  const double shift_m = 0.5 * kLight_mpns * tau_ns;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double t_ns = (i + 0.5) * step_ns;
    const double s_m = range_m + shift_m - 0.5 * kLight_mpns * t_ns;
    const double xi = s_m >= focus_m ? 1.0 : s_m * s_m / (focus_m * focus_m);
    sum += std::pow(std::sin(std::numbers::pi * t_ns / (2.0 * tau_ns)), 2) *
           std::exp(-2.0 * alpha_pm * s_m) * xi / (s_m * s_m) * step_ns;
  }
  return std::numbers::pi * 0.5 * kLight_mpns * sum;
}

WeatherParameters foggy(double mor_m) {
  WeatherParameters parameters;
  parameters.course = {{.fog_visibility_m = mor_m}};
  return parameters;
}

WeatherBeam beam_to(double far_m, double near_m = 0.5) {
  WeatherBeam beam;
  beam.far_m = far_m;
  beam.near_m = near_m;
  beam.pulse_m = 0.5 * kLight_mpns * 5.0;
  beam.divergence_rad = 3e-3;
  return beam;
}

TEST(FogTest, FivePercentOfTheLightIsLeftAtTheOpticalRange) {
  for (const double mor_m : {10.0, 50.0, 200.0, 1000.0}) {
    const AirPath path = SceneWeather(foggy(mor_m), 1).along(beam_to(mor_m));
    EXPECT_NEAR(path.transmission, 0.05 * 0.05, 1e-12);
  }
}

/// An HDL-32E's: nearest 1 m, focused at 8 m.
WeatherBeam fog_beam(double far_m = 80.0) {
  WeatherBeam beam = beam_to(far_m, 1.0);
  beam.focus_m = 8.0;
  return beam;
}

struct Clutter {
  std::vector<double> range_m;
  std::vector<double> energy;
  int shots_with = 0;
};

Clutter clutter(const WeatherParameters& parameters, WeatherBeam beam, int shots,
                std::uint64_t seed = 1) {
  const SceneWeather weather(parameters, 1);
  Clutter found;
  for (int i = 0; i < shots; ++i) {
    beam.draw_key = counter_bits(seed, static_cast<std::uint64_t>(i));
    const AirPath path = weather.along(beam);
    found.shots_with += path.echo_count > 0 ? 1 : 0;
    for (std::size_t k = 0; k < path.echo_count; ++k) {
      found.range_m.push_back(path.echoes[k].range_m);
      found.energy.push_back(path.echoes[k].energy);
    }
  }
  return found;
}

TEST(FogTest, TheMeanEchoIsThePulseIntegral) {
  for (const double mor_m : {10.0, 20.0, 50.0, 100.0, 500.0}) {
    const double alpha_pm = std::log(20.0) / mor_m;
    for (const double range_m : {1.5, 3.0, 6.0, 12.0, 25.0}) {
      const WeatherBeam beam = fog_beam();
      const double expected = 0.046 / mor_m * received(range_m, alpha_pm, 5.0, beam.focus_m);
      EXPECT_NEAR(mean_clutter(beam, range_m, 0.046 / mor_m, alpha_pm * range_m) / expected, 1.0,
                  0.03)
          << mor_m << ' ' << range_m;
    }
  }
}

TEST(FogTest, CellsAreSeenAsOftenAsTheirExponentialDistributionSays) {
  constexpr int kShots = 200'000;
  for (const double mor_m : {20.0, 40.0, 60.0, 100.0}) {
    for (const std::uint64_t seed : {1U, 2U}) {
      const WeatherBeam beam = fog_beam();
      const Clutter found = clutter(foggy(mor_m), beam, kShots, seed);
      // In bands of 1 m: exp(-T / E(r)) of the cells of half a pulse's length.
      for (double from_m = 1.0; from_m < 9.0; from_m += 1.0) {
        double expected = 0.0;
        for (double r_m = from_m + 0.05; r_m < from_m + 1.0; r_m += 0.1) {
          const double mean =
              0.046 / mor_m * received(r_m, std::log(20.0) / mor_m, 5.0, beam.focus_m);
          expected += 0.1 / beam.pulse_m * std::exp(-beam.detection_energy / mean);
        }
        const auto count = static_cast<double>(std::ranges::count_if(
            found.range_m, [&](double r_m) { return r_m >= from_m && r_m < from_m + 1.0; }));
        // 5 sigma, and 5 % for the mean's closed form and the steps along the beam.
        EXPECT_NEAR(count, kShots * expected,
                    5.0 * std::sqrt(kShots * expected) + 0.05 * kShots * expected + 5.0)
            << mor_m << ' ' << from_m;
      }
    }
  }
}

TEST(FogTest, EnergiesAboveTheLimitAreNegativeExponential) {
  for (const double mor_m : {20.0, 60.0}) {
    const WeatherBeam beam = fog_beam();
    const Clutter found = clutter(foggy(mor_m), beam, 400'000);
    double first = 0.0;
    double second = 0.0;
    const auto count = static_cast<double>(found.range_m.size());
    for (std::size_t i = 0; i < found.range_m.size(); ++i) {
      const double above = (found.energy[i] - beam.detection_energy) /
                           mean_clutter(beam, found.range_m[i], 0.046 / mor_m,
                                        std::log(20.0) / mor_m * found.range_m[i]);
      EXPECT_GE(above, 0.0);
      first += above / count;
      second += above * above / count;
    }
    EXPECT_NEAR(first, 1.0, 4.0 / std::sqrt(count)) << mor_m;
    EXPECT_NEAR(second, 2.0, 4.0 * std::sqrt(20.0 / count)) << mor_m;  // variance of x^2: 24 - 4
  }
}

TEST(FogTest, ClutterIsSpreadOverMetresAndFadesWithTheVisibility) {
  std::vector<double> shares;
  for (const double mor_m : {20.0, 40.0, 60.0, 100.0, 200.0}) {
    const Clutter found = clutter(foggy(mor_m), fog_beam(), 100'000);
    shares.push_back(found.shots_with / 1e5);
    if (mor_m > 100.0) {
      continue;
    }
    double sum = 0.0;
    double squares = 0.0;
    for (const double range_m : found.range_m) {
      sum += range_m;
      squares += range_m * range_m;
    }
    const auto count = static_cast<double>(found.range_m.size());
    // Before, all of it was within a centimetre.
    EXPECT_GT(std::sqrt(squares / count - sum / count * sum / count), 0.5) << mor_m;
    EXPECT_GE(*std::ranges::min_element(found.range_m), 1.0) << "nearer than the sensor sees";
  }
  EXPECT_TRUE(std::ranges::is_sorted(shares, std::greater{}));
  EXPECT_GT(shares[1], 0.1);   // 40 m
  EXPECT_LT(shares[4], 0.01);  // 200 m
}

TEST(FogTest, NoClutterIsTakenForASurfaceWithinThePulse) {
  for (const double far_m : {1.5, 3.0, 6.0}) {
    const Clutter found = clutter(foggy(20.0), fog_beam(far_m), 20'000);
    for (const double range_m : found.range_m) {
      EXPECT_LE(range_m, far_m - 0.749);
    }
    EXPECT_EQ(found.range_m.empty(), far_m < 1.75);
  }
}

TEST(FogTest, WithoutFocusTheNearFieldIsLouder) {
  WeatherBeam beam = fog_beam();
  const Clutter focused = clutter(foggy(60.0), beam, 20'000);
  beam.focus_m = 0.0;
  const Clutter open = clutter(foggy(60.0), beam, 20'000);
  EXPECT_GT(open.shots_with, 3 * focused.shots_with);
}

TEST(FogTest, ALayerEchoesWhereItIs) {
  WeatherParameters parameters = foggy(20.0);
  parameters.fog.base_height_m = 0.0;
  parameters.fog.scale_height_m = 0.3;
  WeatherBeam beam = fog_beam(12.0);
  beam.start_W = {0.0, 0.0, 4.0};
  beam.direction_W = Eigen::Vector3d(1.0, 0.0, -0.5).normalized();
  const Clutter found = clutter(parameters, beam, 20'000);
  ASSERT_GT(found.range_m.size(), 100U);
  // It is thinner than a tenth above 0.7 m, 7.4 m along the beam.
  const auto early = std::ranges::count_if(found.range_m, [](double r_m) { return r_m < 6.5; });
  EXPECT_LT(static_cast<double>(early), 0.02 * static_cast<double>(found.range_m.size()));
}

TEST(FogTest, CellsOfALayerAreSeenAsOftenWhereverTheBeamGoes) {
  constexpr int kShots = 60'000;
  WeatherParameters parameters = foggy(25.0);
  parameters.fog.base_height_m = 1.0;
  parameters.fog.scale_height_m = 3.0;
  for (const double climb : {-0.6, -0.2, -0.02, 0.0, 0.1, 0.5}) {
    WeatherBeam beam = fog_beam(climb < 0.0 ? std::min(60.0, 2.2 / -climb) : 60.0);
    beam.start_W = {0.0, 0.0, 2.2};
    beam.direction_W = {std::sqrt(1.0 - climb * climb), 0.0, climb};
    double expected = 0.0;
    for (double r_m = beam.near_m; r_m < beam.far_m - beam.pulse_m; r_m += 0.01) {
      const double mean =
          mean_clutter(beam, r_m, 0.046 / 25.0 * fog_density(parameters.fog, 2.2 + climb * r_m),
                       std::log(20.0) / 25.0 * fog_path_m(parameters.fog, 2.2, climb, r_m));
      expected += 0.01 / beam.pulse_m * std::exp(-beam.detection_energy / mean);
    }
    const double count = kShots * -std::expm1(-expected);
    EXPECT_NEAR(clutter(parameters, beam, kShots).shots_with, count,
                5.0 * std::sqrt(count) + 0.02 * count)
        << climb;
  }
}

TEST(FogTest, LayerIsIntegratedAlongSlopingBeams) {
  FogParameters fog;
  fog.base_height_m = 2.0;
  fog.scale_height_m = 5.0;
  for (const double climb : {-0.5, -0.02, 0.0, 0.02, 0.3, 1.0}) {
    for (const double z0_m : {-3.0, 1.0, 3.0, 20.0}) {
      double expected_m = 0.0;
      constexpr int kSteps = 20000;
      for (int i = 0; i < kSteps; ++i) {
        const double z_m = z0_m + climb * 60.0 * (i + 0.5) / kSteps;
        expected_m += (z_m <= 2.0 ? 1.0 : std::exp(-(z_m - 2.0) / 5.0)) * 60.0 / kSteps;
      }
      EXPECT_NEAR(fog_path_m(fog, z0_m, climb, 60.0), expected_m, 1e-5 * 60.0);
    }
  }
}

TEST(HazeTest, FollowsKruseAtTheLidarsWavelength) {
  WeatherParameters parameters;
  parameters.course = {{.haze_visibility_m = 10000.0}};
  const double expected_pm = 3.912 / 1e4 * std::pow(905.0 / 550.0, -1.3);
  EXPECT_NEAR(SceneWeather(parameters, 1).along(beam_to(100.0)).transmission,
              std::exp(-200.0 * expected_pm), 1e-12);
}

}  // namespace
}  // namespace rigwire::sim
