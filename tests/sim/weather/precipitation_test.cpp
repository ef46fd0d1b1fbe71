// Rain and snow against integrations and a simulation of every drop written here, after the papers.
#include "sim/weather/precipitation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "number_word.h"
#include "sim/random.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::sim {
namespace {

constexpr double kTheta_rad = 3e-3;  // LISA's beam

/// Composite Simpson rule.
template <class Function>
double integral(double from, double to, int pairs, const Function& f) {
  const double h = (to - from) / (2 * pairs);
  double sum = f(from) + f(to);
  for (int i = 1; i < 2 * pairs; ++i) {
    sum += (i % 2 == 1 ? 4.0 : 2.0) * f(from + i * h);
  }
  return sum * h / 3.0;
}

/// Marshall and Palmer, in the paper's units: per m3 and mm, D in mm.
double marshall_palmer(double rain_mmph, double diameter_mm) {
  return 8000.0 * std::exp(-4.1 * std::pow(rain_mmph, -0.21) * diameter_mm);
}

double gunn_marshall(double snow_mmph, double diameter_mm) {
  return 3800.0 * std::pow(snow_mmph, -0.87) *
         std::exp(-2.55 * std::pow(snow_mmph, -0.48) * diameter_mm);
}

template <class Spectrum>
double extinction_by_quadrature(const Spectrum& spectrum) {
  return 1e-6 * std::numbers::pi / 4.0 * integral(0.05, 40.0, 20000, [&](double d_mm) {
           return 2.0 * d_mm * d_mm * spectrum(d_mm);
         });
}

/// Drops in the beam between two ranges whose weakened echo is detected, by a double integral.
double detected_by_quadrature(double rain_mmph, double alpha_pm, double near_m, double far_m,
                              double limit) {
  const double rho = std::pow((1.328 - 1.0) / (1.328 + 1.0), 2);
  return integral(near_m, far_m, 400, [&](double r_m) {
    const double beam_mm = 1e3 * r_m * kTheta_rad;
    const double full = rho * std::exp(-2.0 * alpha_pm * r_m) / (r_m * r_m);
    if (full < limit) {
      return 0.0;
    }
    const double least_mm = std::max(beam_mm * std::sqrt(limit / full), 0.05);
    const double number = integral(least_mm, least_mm + 30.0, 2000,
                                   [&](double d_mm) { return marshall_palmer(rain_mmph, d_mm); });
    return number * std::numbers::pi / 4.0 * std::pow(r_m * kTheta_rad, 2);
  });
}

WeatherBeam lisa_beam(std::uint64_t key, double far_m) {
  WeatherBeam beam;
  beam.far_m = far_m;
  beam.divergence_rad = kTheta_rad;
  beam.draw_key = key;
  return beam;
}

WeatherParameters raining(double rain_mmph) {
  WeatherParameters parameters;
  parameters.course = {{.rain_mmph = rain_mmph}};
  return parameters;
}

TEST(RainTest, ExtinctionIsTheIntegralOfTheMeasuredSpectrum) {
  for (const double rate_mmph : {0.5, 1.0, 5.0, 10.0, 50.0, 100.0}) {
    const double expected_pm =
        extinction_by_quadrature([&](double d_mm) { return marshall_palmer(rate_mmph, d_mm); });
    const SceneWeather weather(raining(rate_mmph), 1);
    EXPECT_NEAR(weather.even_extinction_pm(kStart) / expected_pm, 1.0, 1e-6) << rate_mmph;
    // The power law that the integral down to no diameter at all has.
    EXPECT_NEAR(expected_pm / (3.65e-4 * std::pow(rate_mmph, 0.63)), 1.0, 4e-3) << rate_mmph;
    const AirPath path = weather.along(lisa_beam(1, 100.0));
    EXPECT_NEAR(path.transmission, std::exp(-200.0 * expected_pm), 1e-9);
  }
}

TEST(RainTest, TheSimpleCoefficientIsNeverMixedWithTheDrops) {
  WeatherParameters parameters = raining(10.0);
  parameters.rain.model = RainModel::goodin;
  const SceneWeather weather(parameters, 1);
  EXPECT_NEAR(weather.even_extinction_pm(kStart), 0.01 * std::pow(10.0, 0.6), 1e-12);
  for (std::uint64_t key = 0; key < 20000; ++key) {
    ASSERT_EQ(weather.along(lisa_beam(key, 100.0)).echo_count, 0U);
  }
}

TEST(SnowTest, ExtinctionIsTheIntegralOfTheMeasuredSpectrum) {
  for (const double rate_mmph : {0.1, 0.5, 1.0, 2.5, 5.0}) {
    WeatherParameters parameters;
    parameters.course = {{.snow_mmph = rate_mmph}};
    const double expected_pm =
        extinction_by_quadrature([&](double d_mm) { return gunn_marshall(rate_mmph, d_mm); });
    EXPECT_NEAR(SceneWeather(parameters, 1).even_extinction_pm(kStart) / expected_pm, 1.0, 1e-6);
  }
}

class FalseReturnRateTest : public testing::TestWithParam<double> {};

TEST_P(FalseReturnRateTest, IsThatOfADoubleIntegralWithinThreeSigma) {
  constexpr int kBeams = 300000;
  const double rate_mmph = GetParam();
  const SceneWeather weather(raining(rate_mmph), 1);
  const double alpha_pm =
      extinction_by_quadrature([&](double d_mm) { return marshall_palmer(rate_mmph, d_mm); });
  const double drops = detected_by_quadrature(rate_mmph, alpha_pm, 1.5, 15.0, 0.9e-4);
  const double expected = 1.0 - std::exp(-drops);
  int returned = 0;
  int echoes = 0;
  for (std::uint64_t key = 0; key < kBeams; ++key) {
    const AirPath path = weather.along(lisa_beam(key * 0x9E3779B97F4A7C15ULL + 5, 100.0));
    returned += path.echo_count > 0 ? 1 : 0;
    echoes += static_cast<int>(path.echo_count);
  }
  const double sigma = std::sqrt(expected * (1.0 - expected) / kBeams);
  EXPECT_NEAR(static_cast<double>(returned) / kBeams, expected, 3.0 * sigma);
  EXPECT_NEAR(static_cast<double>(echoes) / kBeams, drops, 3.0 * std::sqrt(drops / kBeams));
}

INSTANTIATE_TEST_SUITE_P(Rates, FalseReturnRateTest,
                         testing::Values(0.5, 2.0, 5.0, 10.0, 30.0, 100.0), [](const auto& test) {
                           return "rain_of_" + rigwire::test::number_word(test.param) + "_mmph";
                         });

TEST(RainTest, ABeamThatMeetsASurfaceSeesOnlyTheDropsBefore) {
  const SceneWeather weather(raining(30.0), 1);
  int all = 0;
  int before = 0;
  for (std::uint64_t key = 0; key < 200000; ++key) {
    const AirPath free = weather.along(lisa_beam(key, 100.0));
    const AirPath cut = weather.along(lisa_beam(key, 2.0));
    for (std::size_t i = 0; i < cut.echo_count; ++i) {
      ASSERT_LE(cut.echoes[i].range_m, 2.0);
      ASSERT_GE(cut.echoes[i].range_m, 1.5);
      ++before;
    }
    all += static_cast<int>(free.echo_count);
  }
  const double alpha_pm =
      extinction_by_quadrature([](double d_mm) { return marshall_palmer(30.0, d_mm); });
  const double expected = 200000 * detected_by_quadrature(30.0, alpha_pm, 1.5, 2.0, 0.9e-4);
  EXPECT_NEAR(before, expected, 3.0 * std::sqrt(expected));
  EXPECT_GT(all, before);
}

/// LISA as printed: every drop of the cone in front of a surface, and the strongest that is seen.
struct EveryDrop {
  int returned = 0;
  double range_sum_m = 0.0;
  double range_squares_m2 = 0.0;
  double log_energy_sum = 0.0;
  double log_energy_squares = 0.0;

  void add(double range_m, double energy) {
    ++returned;
    range_sum_m += range_m;
    range_squares_m2 += range_m * range_m;
    log_energy_sum += std::log(energy);
    log_energy_squares += std::pow(std::log(energy), 2);
  }
};

EveryDrop every_drop(double rain_mmph, double alpha_pm, double far_m, double limit, int beams) {
  RandomStream stream(7, "every drop");
  const double slope_pmm = 4.1 * std::pow(rain_mmph, -0.21);
  const double drops = 8000.0 * std::exp(-slope_pmm * 0.05) / slope_pmm * std::numbers::pi / 3.0 *
                       far_m * std::pow(far_m * std::tan(0.5 * kTheta_rad), 2);
  EveryDrop result;
  for (int beam = 0; beam < beams; ++beam) {
    double best = 0.0;
    double best_m = 0.0;
    const int number = static_cast<int>(drops) + (stream.uniform() < drops - std::floor(drops));
    for (int i = 0; i < number; ++i) {
      const double r_m = far_m * std::cbrt(stream.uniform());
      const double d_mm = 0.05 - std::log(1.0 - stream.uniform()) / slope_pmm;
      if (r_m < 1.5) {
        continue;
      }
      const double energy = std::pow(0.328 / 2.328, 2) * std::exp(-2.0 * alpha_pm * r_m) *
                            std::min(std::pow(d_mm / (1e3 * r_m * kTheta_rad), 2), 1.0) /
                            (r_m * r_m);
      if (energy > best) {
        best = energy;
        best_m = r_m;
      }
    }
    if (best >= limit) {
      result.add(best_m, best);
    }
  }
  return result;
}

TEST(RainTest, DrawingOnlyWhatIsDetectedIsDrawingEveryDrop) {
  constexpr int kBeams = 300000;
  constexpr double kFar_m = 8.0;
  const double alpha_pm =
      extinction_by_quadrature([](double d_mm) { return marshall_palmer(20.0, d_mm); });
  const EveryDrop expected = every_drop(20.0, alpha_pm, kFar_m, 0.9e-4, kBeams);
  const SceneWeather weather(raining(20.0), 1);
  EveryDrop found;
  for (std::uint64_t key = 0; key < kBeams; ++key) {
    const AirPath path = weather.along(lisa_beam(key, kFar_m));
    AirEcho strongest;
    for (std::size_t i = 0; i < path.echo_count; ++i) {
      if (path.echoes[i].energy > strongest.energy) {
        strongest = path.echoes[i];
      }
    }
    if (strongest.energy > 0.0) {
      found.add(strongest.range_m, strongest.energy);
    }
  }
  const double n = found.returned;
  const double m = expected.returned;
  ASSERT_GT(m, 1000.0);
  EXPECT_NEAR(n, m, 3.0 * std::sqrt(n + m));
  const auto compare = [&](double sum, double squares, double sum0, double squares0) {
    const double variance = squares / n - std::pow(sum / n, 2);
    const double variance0 = squares0 / m - std::pow(sum0 / m, 2);
    EXPECT_NEAR(sum / n, sum0 / m, 3.0 * std::sqrt(variance / n + variance0 / m));
  };
  compare(found.range_sum_m, found.range_squares_m2, expected.range_sum_m,
          expected.range_squares_m2);
  compare(found.log_energy_sum, found.log_energy_squares, expected.log_energy_sum,
          expected.log_energy_squares);
}

TEST(RainTest, AFarReachingLidarInACloudburstKeepsTheBrightestDrops) {
  const SceneWeather weather(raining(300.0), 1);
  for (std::uint64_t key = 0; key < 200; ++key) {
    WeatherBeam beam = lisa_beam(key, 1000.0);
    beam.divergence_rad = 0.05;
    beam.detection_energy = 1e-9;
    const AirPath path = weather.along(beam);
    ASSERT_EQ(path.echo_count, kMaxAirEchoes);
    for (std::size_t i = 1; i < path.echo_count; ++i) {
      ASSERT_GE(path.echoes[i].range_m, path.echoes[i - 1].range_m);
    }
  }
}

TEST(RainTest, ABeamWithoutWidthOrReachMeetsNoDrop) {
  const SceneWeather weather(raining(100.0), 1);
  for (std::uint64_t key = 0; key < 1000; ++key) {
    WeatherBeam narrow = lisa_beam(key, 100.0);
    narrow.divergence_rad = 0.0;
    ASSERT_EQ(weather.along(narrow).echo_count, 0U);
    ASSERT_EQ(weather.along(lisa_beam(key, 0.0)).echo_count, 0U);
  }
}

}  // namespace
}  // namespace rigwire::sim
