// Fog and haze against an integration in time written here, as the paper prints it.
#include "sim/weather/droplets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/weather/scene_weather.h"

namespace rigwire::sim {
namespace {

constexpr double kLight_mpns = 0.299792458;

/// Received power at range R of a pulse sin^2(pi t / 2 tau), 0 <= t <= 2 tau, from an even fog in
/// front of a surface: Hahner's integral over time, per beta, with light's own way in metres.
double received(double range_m, double alpha_pm, double tau_ns, double far_m) {
  constexpr int kSteps = 1500;
  const double step_ns = 2.0 * tau_ns / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double t_ns = (i + 0.5) * step_ns;
    const double s_m = range_m - 0.5 * kLight_mpns * t_ns;
    if (s_m <= 0.9 || s_m > far_m) {
      continue;
    }
    const double xi = s_m >= 1.0 ? 1.0 : (s_m - 0.9) / 0.1;
    sum += std::pow(std::sin(std::numbers::pi * t_ns / (2.0 * tau_ns)), 2) *
           std::exp(-2.0 * alpha_pm * s_m) * xi / (s_m * s_m) * step_ns;
  }
  return 0.5 * kLight_mpns * sum;
}

struct Peak {
  double range_m = 0.0;  // of the pulse's middle
  double energy = 0.0;   // for beta = 1
};

Peak peak_of(double alpha_pm, double tau_ns, double near_m, double far_m) {
  Peak peak;
  const double shift_m = 0.5 * kLight_mpns * tau_ns;
  for (double range_m = std::max(near_m, 0.5); range_m < near_m + 3.0; range_m += 0.01) {
    const double energy = std::numbers::pi * received(range_m + shift_m, alpha_pm, tau_ns, far_m);
    if (energy > peak.energy) {
      peak = {range_m, energy};
    }
  }
  return peak;
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

TEST(FogTest, SoftEchoIsTheLargestOfThePulseIntegral) {
  for (const double mor_m : {10.0, 20.0, 50.0, 100.0}) {
    for (const double near_m : {0.5, 1.5, 2.5}) {
      const Peak expected = peak_of(std::log(20.0) / mor_m, 5.0, near_m, 1e3);
      WeatherBeam beam = beam_to(80.0, near_m);
      beam.detection_energy = 1e-9;
      const AirPath path = SceneWeather(foggy(mor_m), 1).along(beam);
      ASSERT_EQ(path.echo_count, 1U);
      EXPECT_NEAR(path.echoes[0].energy / (expected.energy * 0.046 / mor_m), 1.0, 3e-3);
      EXPECT_NEAR(path.echoes[0].range_m, expected.range_m, 0.02);
    }
  }
}

TEST(FogTest, SoftEchoAppearsAtTheOpticalRangeWhereTheIntegralReachesTheLimit) {
  const auto seen = [](double mor_m) {
    return SceneWeather(foggy(mor_m), 1).along(beam_to(80.0)).echo_count > 0;
  };
  const auto expected = [](double mor_m) {
    return peak_of(std::log(20.0) / mor_m, 5.0, 0.5, 1e3).energy * 0.046 / mor_m >= 0.9e-4;
  };
  const auto threshold_m = [](const auto& there) {
    double low_m = 10.0;
    double high_m = 5000.0;
    for (int i = 0; i < 14; ++i) {
      const double middle_m = std::sqrt(low_m * high_m);
      (there(middle_m) ? low_m : high_m) = middle_m;
    }
    return low_m;
  };
  const double found_m = threshold_m(seen);
  EXPECT_NEAR(found_m / threshold_m(expected), 1.0, 5e-3);
  EXPECT_GT(found_m, 100.0);
  EXPECT_LT(found_m, 5000.0);
}

TEST(FogTest, ASurfaceWithinThePulseCutsTheSoftEchoShort) {
  for (const double far_m : {1.2, 1.5, 1.9}) {
    const double alpha_pm = std::log(20.0) / 20.0;
    Peak expected;
    const double shift_m = 0.5 * kLight_mpns * 5.0;
    for (double range_m = 0.5; range_m <= far_m; range_m += 0.005) {
      const double energy = std::numbers::pi * received(range_m + shift_m, alpha_pm, 5.0, far_m);
      if (energy > expected.energy) {
        expected = {range_m, energy};
      }
    }
    const AirPath path = SceneWeather(foggy(20.0), 1).along(beam_to(far_m));
    ASSERT_EQ(path.echo_count, 1U);
    EXPECT_NEAR(path.echoes[0].energy / (expected.energy * 0.046 / 20.0), 1.0, 2e-2);
    EXPECT_LE(path.echoes[0].range_m, far_m);
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
