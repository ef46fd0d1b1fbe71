#include "sim/lidar/echo_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/lidar/link_budget.h"

namespace rigwire::sim {
namespace {

constexpr int kPackets = 5000;

LidarPattern head() {
  LidarPattern pattern;
  pattern.lasers.resize(32);
  pattern.minimum_range_m = 1.0;
  pattern.maximum_range_m = 100.0;
  return pattern;
}

EchoLanes all(float range_m, float brightness) {
  EchoLanes echo;
  echo.range_m.fill(range_m);
  echo.brightness.fill(brightness);
  echo.energy.fill(brightness / (range_m * range_m));
  return echo;
}

ShotNumbers shots(int packet, std::size_t laser = 0) {
  ShotNumbers numbers;
  for (std::size_t i = 0; i < kLanes; ++i) {
    numbers[i] = (static_cast<std::size_t>(packet) * kLanes + i) * kMaxLasers + laser;
  }
  return numbers;
}

struct Statistics {
  double mean = 0.0;
  double sigma = 0.0;
  double seen = 0.0;  ///< Share.
};

Statistics measure(const EchoModel& model, const EchoLanes& echo,
                   EchoRank rank = EchoRank::strongest) {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (int packet = 0; packet < kPackets; ++packet) {
    for (const LidarReturn& one : model.report(echo, shots(packet), rank)) {
      if (one.range_m > 0.0F) {
        const auto off = static_cast<double>(one.range_m - echo.range_m[0]);
        count += 1.0;
        sum += off;
        squares += off * off;
      }
    }
  }
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean), count / (kPackets * double{kLanes})};
}

EchoModel model_of(const std::function<void(SpinningLidarParameters&)>& change) {
  SpinningLidarParameters parameters;
  change(parameters);
  return {parameters, head(), 1, "lidar"};
}

TEST(EchoModel, ConstantNoiseHasItsSpreadWhateverTheSignal) {
  const EchoModel model = model_of([](auto& p) { p.range_sigma_m = 0.03; });
  for (const float brightness : {0.1F, 0.9F}) {
    const Statistics found = measure(model, all(20.0F, brightness));
    EXPECT_EQ(found.seen, 1.0);
    EXPECT_NEAR(found.mean, 0.0, 3.0 * 0.03 / 200.0);             // sqrt(40000) draws
    EXPECT_NEAR(found.sigma, 0.03, 3.0 * 0.03 / std::sqrt(8e4));  // sigma / sqrt(2 n)
  }
}

TEST(EchoModel, NoiseBySignalFollowsTheSignalToNoiseRatio) {
  const EchoModel model = model_of([](auto& p) {
    p.range_noise = RangeNoise::signal;
    p.range_sigma_m = 0.0;
  });
  for (const double snr : {1.001, 4.0, 100.0}) {
    // At 20 m the faintest echo has the brightness 0.9 (20 / 100)^2.
    const auto brightness = static_cast<float>(snr * 0.9 * 0.04);
    const double expected = 0.09 / std::sqrt(2.0 * snr);
    const Statistics found = measure(model, all(20.0F, brightness));
    EXPECT_NEAR(found.sigma, expected, 3.0 * expected / std::sqrt(8e4)) << snr;
    EXPECT_NEAR(found.mean, 0.0, 3.0 * expected / 200.0);
  }
}

TEST(EchoModel, JitterFallsWithTheSignal) {
  const EchoModel model = model_of([](auto& p) {
    p.range_noise = RangeNoise::jitter;
    p.range_sigma_m = 0.005;
    p.noise_onset = 3.0;
    p.reflectivity_sigma = 0.04;
  });
  for (const double snr : {1.001, 3.0, 10.0, 100.0}) {
    const auto brightness = static_cast<float>(snr * 0.9 * 0.04);
    const double expected = 0.005 * std::hypot(1.0, 3.0 / snr);
    const Statistics found = measure(model, all(20.0F, brightness));
    EXPECT_NEAR(found.sigma, expected, 3.0 * expected / std::sqrt(8e4)) << snr;
    // The reflectivity by the same factor; 40 000 draws.
    double squares = 0.0;
    for (int packet = 0; packet < kPackets; ++packet) {
      for (const LidarReturn& one :
           model.report(all(20.0F, brightness), shots(packet), EchoRank::strongest)) {
        const double off = static_cast<double>(one.reflectivity / brightness) - 1.0;
        squares += off * off / (kPackets * double{kLanes});
      }
    }
    if (brightness < 0.8F) {
      const double share = 0.04 * std::hypot(1.0, 3.0 / snr);
      EXPECT_NEAR(std::sqrt(squares), share, 0.01 * share) << snr;
    }
  }
}

TEST(EchoModel, SpeckleIsIndependentOfTheRangeNoiseAndFromShotToShot) {
  for (const std::uint64_t key : {1U, 99U}) {
    std::vector<std::uint64_t> numbers(200'000);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = i * kMaxLasers;
    }
    std::vector<float> normal(numbers.size());
    std::vector<float> speckle(numbers.size());
    gaussian(key, numbers, normal, speckle);
    double sum = 0.0;
    double squares = 0.0;
    double with_range = 0.0;
    double with_next = 0.0;
    const auto count = static_cast<double>(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const double one = speckle[i];
      sum += one / count;
      squares += one * one / count;
      with_range += one * static_cast<double>(normal[i]) / count;
      with_next += i > 0 ? one * static_cast<double>(speckle[i - 1]) / count : 0.0;
      EXPECT_LE(std::abs(one), 3.46);
    }
    const double tolerance = 4.0 / std::sqrt(count);
    EXPECT_NEAR(sum, 0.0, tolerance);
    EXPECT_NEAR(squares, 1.0, std::sqrt(2.0) * tolerance);
    EXPECT_NEAR(with_range, 0.0, tolerance);
    EXPECT_NEAR(with_next, 0.0, tolerance);
  }
}

TEST(EchoModel, ALasersReflectivityChangesWhatIsReportedAndNotWhatIsSeen) {
  const EchoModel model = model_of([](auto& p) {
    p.range_sigma_m = 0.0;
    p.laser_reflectivity_sigma = 0.2;
  });
  for (std::size_t laser = 0; laser < kMaxLasers; ++laser) {
    const EightReturns near = model.report(all(20.0F, 0.4F), shots(3, laser), EchoRank::strongest);
    EXPECT_FLOAT_EQ(near[0].reflectivity, 0.4F * model.reflectivity_gain(laser));
    const auto at = [&](float range_m) {
      return model.report(all(range_m, 0.1F), shots(3, laser), EchoRank::strongest)[0].range_m;
    };
    EXPECT_GT(at(33.3F), 0.0F);  // 100 m sqrt(0.1 / 0.9)
    EXPECT_EQ(at(33.4F), 0.0F);
  }
}

TEST(EchoModel, ConstantAndSignalErrorsAddAsIndependentOnes) {
  EXPECT_NEAR(range_spread_m(0.03, 0.08, 2.0), 0.05, 1e-15);  // 0.04 = 0.08 / sqrt(4)
}

TEST(EchoModel, EchoesOfOneShotHaveErrorsOfTheirOwn) {
  const EchoModel model = model_of([](auto&) {});
  const EightReturns strongest = model.report(all(20.0F, 0.5F), shots(7), EchoRank::strongest);
  EXPECT_EQ(strongest, model.report(all(20.0F, 0.5F), shots(7), EchoRank::strongest));
  for (const EchoRank rank : {EchoRank::second, EchoRank::last}) {
    const EightReturns other = model.report(all(20.0F, 0.5F), shots(7), rank);
    for (std::size_t i = 0; i < kLanes; ++i) {
      EXPECT_NE(other[i].range_m, strongest[i].range_m);
    }
  }
}

TEST(EchoModel, AWhiteTargetVanishesAtItsRangeAndADarkOneSooner) {
  const EchoModel model = model_of([](auto& p) { p.range_sigma_m = 0.0; });
  const auto seen = [&](double range_m, double reflectance) {
    return model
               .report(all(static_cast<float>(range_m), static_cast<float>(reflectance)), shots(0),
                       EchoRank::strongest)[0]
               .range_m > 0.0F;
  };
  EXPECT_TRUE(seen(99.99, 0.9));
  EXPECT_FALSE(seen(100.01, 0.9));
  const double dark_m = 100.0 / 3.0;  // sqrt(0.1 / 0.9)
  EXPECT_TRUE(seen(dark_m - 0.01, 0.1));
  EXPECT_FALSE(seen(dark_m + 0.01, 0.1));
  EXPECT_FALSE(seen(0.99, 0.9));
}

TEST(EchoModel, TheReferenceRangeIsApartFromTheFarthestThatIsReported) {
  const EchoModel model = model_of([](auto& p) {
    p.range_sigma_m = 0.0;
    p.reference_range_m = 30.0;
  });
  const auto first = [&](float range_m, float brightness) {
    return model.report(all(range_m, brightness), shots(0), EchoRank::strongest)[0];
  };
  EXPECT_EQ(first(30.1F, 0.9F).range_m, 0.0F);
  EXPECT_EQ(first(29.9F, 0.9F).range_m, 29.9F);
  EXPECT_EQ(first(90.0F, 100.0F).range_m, 90.0F);
}

TEST(EchoModel, ReflectivityTellsDiffuseFromRetroReflecting) {
  EXPECT_DOUBLE_EQ(reported_reflectivity(0.37), 0.37);
  EXPECT_DOUBLE_EQ(reported_reflectivity(1.0), 1.0);
  EXPECT_NEAR(reported_reflectivity(apparent_reflectance(0.0, 0.5, 1.0)), 1.5, 1e-3);
  EXPECT_NEAR(reported_reflectivity(apparent_reflectance(0.0, 1.0, 1.0)), 2.0, 1e-12);
  EXPECT_DOUBLE_EQ(reported_reflectivity(5000.0), 2.0);
  EXPECT_DOUBLE_EQ(retro_acceptance(std::cos(0.3)), 1.0);       // 17 degrees
  EXPECT_NEAR(retro_acceptance(std::cos(0.5236)), 0.54, 0.01);  // 30 degrees
  EXPECT_DOUBLE_EQ(retro_acceptance(std::cos(0.65)), 0.0);      // 37 degrees
}

TEST(EchoModel, EveryLaserHasAConstantErrorOfItsOwn) {
  const auto biased = [](auto& p) {
    p.range_sigma_m = 0.0;
    p.laser_bias_sigma_m = 0.02;
  };
  const EchoModel model = model_of(biased);
  const EchoModel again = model_of(biased);
  double squares = 0.0;
  for (std::size_t laser = 0; laser < kMaxLasers; ++laser) {
    const float bias_m = model.bias_m(laser);
    squares += static_cast<double>(bias_m * bias_m);
    EXPECT_EQ(bias_m, again.bias_m(laser));
    for (const int packet : {0, 99}) {
      const EightReturns found =
          model.report(all(20.0F, 0.5F), shots(packet, laser), EchoRank::strongest);
      EXPECT_FLOAT_EQ(found[3].range_m, 20.0F + bias_m);
    }
  }
  EXPECT_NEAR(std::sqrt(squares / kMaxLasers), 0.02, 3.0 * 0.02 / std::sqrt(2.0 * kMaxLasers));
}

TEST(EchoModel, LossesComeAtTheirRates) {
  const double shots_cast = kPackets * double{kLanes};
  const auto tolerance = [&](double p) { return 3.0 * std::sqrt(p * (1.0 - p) / shots_cast); };
  const EchoModel general = model_of([](auto& p) { p.drop_rate = 0.3; });
  EXPECT_NEAR(measure(general, all(20.0F, 0.5F)).seen, 0.7, tolerance(0.7));
  const EchoModel faint = model_of([](auto& p) {
    p.drop_limit = 0.8;
    p.drop_at_zero = 0.4;
  });
  EXPECT_EQ(measure(faint, all(20.0F, 0.85F)).seen, 1.0);
  const double keep = 0.4 / 0.8 * 0.2 + (1.0 - 0.4);
  EXPECT_NEAR(measure(faint, all(20.0F, 0.2F)).seen, keep, tolerance(keep));
}

TEST(EchoModel, ALostShotHasLostAllItsEchoes) {
  const EchoModel model = model_of([](auto& p) { p.drop_rate = 0.5; });
  for (int packet = 0; packet < 100; ++packet) {
    const EightReturns strongest =
        model.report(all(20.0F, 0.5F), shots(packet), EchoRank::strongest);
    const EightReturns last = model.report(all(30.0F, 0.5F), shots(packet), EchoRank::last);
    for (std::size_t i = 0; i < kLanes; ++i) {
      EXPECT_EQ(strongest[i].range_m > 0.0F, last[i].range_m > 0.0F);
    }
  }
}

TEST(EchoModel, ParametersThatMakeNoSenseAreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const std::string& name,
                          const std::function<void(SpinningLidarParameters&)>& change) {
    try {
      static_cast<void>(model_of(change));
      ADD_FAILURE() << name << " was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  };
  refused("sub_rays: found 6, allowed 0, 1, 5, 19 or 1000", [](auto& p) { p.sub_rays = 6; });
  refused("range_sigma: found nan", [=](auto& p) { p.range_sigma_m = nan; });
  refused("drop_rate: found 110 %, allowed 0 .. 100 %", [](auto& p) { p.drop_rate = 1.1; });
  refused("drop_at_zero: found -10 %", [](auto& p) { p.drop_at_zero = -0.1; });
  refused("blooming_share: found 50 %, allowed 0 .. 10 %", [](auto& p) { p.blooming_share = 0.5; });
  refused("reference_range: found -1 m, allowed 0 .. 1000 m",
          [](auto& p) { p.reference_range_m = -1.0; });
  refused("laser_bias_sigma: found 2000 mm, allowed 0 .. 1000 mm",
          [](auto& p) { p.laser_bias_sigma_m = 2.0; });
  refused("range_noise: holds none of its names, allowed constant, signal, jitter",
          [](auto& p) { p.range_noise = static_cast<RangeNoise>(9); });
}

}  // namespace
}  // namespace rigwire::sim
