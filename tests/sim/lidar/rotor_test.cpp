#include "sim/lidar/rotor.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace rigwire::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kRotorRate = 10.0 * kTurn;

LidarCommand turning(double rate_radps) {
  LidarCommand command;
  command.rotor_rate_radps = rate_radps;
  return command;
}

LidarCommand locked(double rate_radps, double azimuth_rad, SimTime pulse = kStart) {
  LidarCommand command = turning(rate_radps);
  command.phase_lock = PhaseLock{azimuth_rad, pulse};
  return command;
}

double error_of(double azimuth_rad, double expected_rad) {
  return std::abs(std::remainder(azimuth_rad - expected_rad, kTurn));
}

TEST(Rotor, TurnsEvenlyFromTheStartUnlessItStartsAtRest) {
  Rotor rotor(turning(kRotorRate));
  EXPECT_EQ(rotor.at(kStart).azimuth_rad, 0.0);
  EXPECT_NEAR(rotor.at(kStart + milliseconds{25}).azimuth_rad, 0.25 * kTurn, 1e-12);
  EXPECT_LT(
      error_of(rotor.at(kStart + seconds{600} + microseconds{12'500}).azimuth_rad, 0.125 * kTurn),
      1e-9);
}

TEST(Rotor, SpinsUpWithinItsTorqueAndTheAzimuthIsTheIntegralOfTheSpeed) {
  RotorParameters parameters;
  parameters.starts_at_rest = true;
  Rotor rotor(turning(kRotorRate), parameters);
  RotorState before = rotor.at(kStart);
  EXPECT_EQ(before.rate_radps, 0.0);
  double integral = 0.0;
  const double step_s = 1e-4;
  for (int i = 1; i <= 40'000; ++i) {
    const RotorState state = rotor.at(kStart + microseconds{100} * i);
    // Speed is linear in between: the trapezium is exact.
    integral += 0.5 * step_s * (before.rate_radps + state.rate_radps);
    EXPECT_LT(error_of(state.azimuth_rad, integral), 1e-9) << i;
    EXPECT_GE(state.rate_radps, before.rate_radps);
    EXPECT_LE(state.rate_radps - before.rate_radps, 1.0001 * 30.0 * step_s);
    before = state;
  }
  EXPECT_EQ(before.rate_radps, kRotorRate);
  // Full torque from rest, and an exponential end of speed a tau, which costs a tau^2 / 2 more.
  EXPECT_NEAR(integral,
              kRotorRate * 4.0 - 0.5 * kRotorRate * kRotorRate / 30.0 - 0.5 * 30.0 * 0.1 * 0.1,
              1e-3 * kRotorRate);
}

TEST(Rotor, SpeedFollowsASmallStepWithItsTimeConstant) {
  Rotor rotor(turning(kRotorRate));
  rotor.command(kStart + seconds{1}, turning(kRotorRate + 1.0));
  const double after_one = rotor.at(kStart + seconds{1} + milliseconds{101}).rate_radps;
  EXPECT_NEAR(after_one - kRotorRate, 1.0 - std::exp(-1.0), 2e-3);
}

TEST(Rotor, ComesToRestAndStands) {
  Rotor rotor(turning(kRotorRate));
  rotor.command(kStart + seconds{1}, turning(0.0));
  double least = kRotorRate;
  for (int ms = 1000; ms < 6000; ++ms) {
    least = std::min(least, rotor.at(kStart + milliseconds{ms}).rate_radps);
  }
  EXPECT_EQ(least, 0.0) << "it never turns back";
  const double azimuth = rotor.at(kStart + seconds{6}).azimuth_rad;
  EXPECT_EQ(rotor.at(kStart + seconds{7}).azimuth_rad, azimuth);
  rotor.command(kStart + seconds{7}, turning(-kRotorRate));
  EXPECT_EQ(rotor.at(kStart + seconds{12}).rate_radps, -kRotorRate);
}

TEST(Rotor, AskingMoreOrLessOftenChangesNothing) {
  RotorParameters parameters;
  parameters.wander_radps = 0.3;
  Rotor often(turning(kRotorRate), parameters, 7, "lidar");
  Rotor seldom(turning(kRotorRate), parameters, 7, "lidar");
  Rotor other(turning(kRotorRate), parameters, 7, "other");
  RotorState last;
  for (int i = 1; i <= 30'000; ++i) {
    last = often.at(kStart + microseconds{46} * i);
  }
  const RotorState same = seldom.at(kStart + microseconds{46} * 30'000);
  EXPECT_EQ(same.azimuth_rad, last.azimuth_rad);
  EXPECT_EQ(same.rate_radps, last.rate_radps);
  EXPECT_NE(other.at(kStart + microseconds{46} * 30'000).rate_radps, last.rate_radps);
}

TEST(Rotor, WandersWithItsSpreadAndItsCorrelation) {
  RotorParameters parameters;
  parameters.wander_radps = 0.3;
  parameters.wander_correlation_s = 0.1;
  Rotor rotor(turning(kRotorRate), parameters, 3, "lidar");
  std::vector<double> deviation;
  constexpr int kSamples = 200'000;  // 200 s: 1000 independent ones
  for (int ms = 0; ms < kSamples; ++ms) {
    deviation.push_back(rotor.at(kStart + milliseconds{ms}).rate_radps - kRotorRate);
  }
  double sum = 0.0;
  double square = 0.0;
  double later = 0.0;
  for (int i = 0; i + 100 < kSamples; ++i) {
    const auto k = static_cast<std::size_t>(i);
    sum += deviation[k];
    square += deviation[k] * deviation[k];
    later += deviation[k] * deviation[k + 100];
  }
  const double count = kSamples - 100;
  EXPECT_NEAR(sum / count, 0.0, 4.0 * 0.3 / std::sqrt(1000.0));
  EXPECT_NEAR(std::sqrt(square / count), 0.3, 4.0 * 0.3 / std::sqrt(2.0 * 1000.0));
  EXPECT_NEAR(later / square, std::exp(-1.0), 0.13);
}

TEST(Rotor, EncoderReadsWithNoiseOfItsOwnAndTheShaftKnowsNothingOfIt) {
  RotorParameters parameters;
  parameters.encoder_noise_rad = 1e-4;
  Rotor noisy(turning(kRotorRate), parameters, 3, "lidar");
  Rotor even(turning(kRotorRate));
  double squares = 0.0;
  double neighbours = 0.0;
  double before = 0.0;
  constexpr int kReadings = 20'000;
  for (int i = 0; i < kReadings; ++i) {
    const SimTime time = kStart + microseconds{50} * i;
    const RotorState state = noisy.at(time);
    ASSERT_EQ(state.azimuth_rad, even.at(time).azimuth_rad);
    const double off = std::remainder(state.encoder_rad - state.azimuth_rad, kTurn);
    squares += off * off;
    neighbours += off * before;
    before = off;
  }
  EXPECT_NEAR(std::sqrt(squares / kReadings), 1e-4, 4.0 * 1e-4 / std::sqrt(2.0 * kReadings));
  EXPECT_NEAR(neighbours / squares, 0.0, 4.0 / std::sqrt(kReadings));
  Rotor standing(turning(0.0), parameters, 3, "lidar");
  EXPECT_EQ(standing.at(kStart + seconds{1}).encoder_rad, 0.0);
}

TEST(Rotor, SpeedRisesAndFallsOnceInATurnAtAPhaseOfTheUnit) {
  RotorParameters parameters;
  parameters.ripple_radps = 0.1;
  const auto fastest_at = [&](std::uint64_t seed) {
    Rotor rotor(turning(kRotorRate), parameters, seed, "lidar");
    double fastest = 0.0;
    double slowest = 1e9;
    double at_rad = 0.0;
    for (int ms = 0; ms < 300; ++ms) {
      const RotorState state = rotor.at(kStart + milliseconds{ms});
      slowest = std::min(slowest, state.rate_radps);
      if (state.rate_radps > fastest) {
        fastest = state.rate_radps;
        at_rad = state.azimuth_rad;
      }
    }
    EXPECT_NEAR(fastest, kRotorRate + 0.1, 2e-4);
    EXPECT_NEAR(slowest, kRotorRate - 0.1, 2e-4);
    EXPECT_LT(error_of(rotor.at(kStart + seconds{10}).azimuth_rad, 0.0),
              0.1 / kRotorRate * 2.0 + 1e-4)
        << "no turn is gained";
    return at_rad;
  };
  EXPECT_GT(error_of(fastest_at(1), fastest_at(2)), 0.05);
}

TEST(Rotor, NeverTurnsBackwardsHoweverItWanders) {
  RotorParameters parameters;
  parameters.wander_radps = 10.0;
  parameters.wander_correlation_s = 0.05;
  Rotor rotor(turning(12.0), parameters, 1, "lidar");
  double least = 12.0;
  double before = 0.0;
  for (int i = 1; i < 200'000; ++i) {
    const RotorState state = rotor.at(kStart + microseconds{100} * i);
    least = std::min(least, state.rate_radps);
    ASSERT_GE(std::remainder(state.azimuth_rad - before, kTurn), -1e-12);
    before = state.azimuth_rad;
  }
  EXPECT_GE(least, -1e-12);
  EXPECT_LT(least, 1.0) << "the wander came to the end of its room";
}

TEST(Rotor, PassesTheLockedAzimuthAtTheTopOfEachSecond) {
  const SimTime pulse = kStart + milliseconds{137};
  RotorParameters parameters;
  parameters.starts_at_rest = true;
  Rotor rotor(locked(kRotorRate, 1.25, pulse), parameters);
  double before = kRotorRate;
  for (int s = 15; s <= 180; ++s) {
    const RotorState state = rotor.at(pulse + seconds{s});
    EXPECT_LT(error_of(state.azimuth_rad, 1.25), 1e-6) << s;
    before = state.rate_radps;
  }
  EXPECT_NEAR(before, kRotorRate, 1e-6);
}

TEST(Rotor, SlewsToANewPhaseBySmallChangesOfSpeed) {
  Rotor rotor(locked(kRotorRate, 0.0));
  EXPECT_LT(error_of(rotor.at(kStart + seconds{1}).azimuth_rad, 0.0), 1e-6);
  rotor.command(kStart + seconds{1}, locked(kRotorRate, 0.45 * kTurn));
  double least = kRotorRate;
  double greatest = kRotorRate;
  for (int ms = 1000; ms < 15'000; ++ms) {
    const double rate = rotor.at(kStart + milliseconds{ms}).rate_radps;
    least = std::min(least, rate);
    greatest = std::max(greatest, rate);
  }
  EXPECT_GT(least, 0.989 * kRotorRate);
  EXPECT_NEAR(greatest, 1.01 * kRotorRate, 0.001 * kRotorRate);
  EXPECT_LT(error_of(rotor.at(kStart + seconds{15}).azimuth_rad, 0.45 * kTurn), 1e-6);
}

TEST(Rotor, HoldsThePhaseForMinutesWhileItWanders) {
  RotorParameters parameters;
  parameters.wander_radps = 0.157;  // 1.5 rpm
  Rotor rotor(locked(kRotorRate, 2.0), parameters, 11, "lidar");
  double square = 0.0;
  double worst = 0.0;
  constexpr int kSeconds = 1200;
  for (int s = 5; s < 5 + kSeconds; ++s) {
    const double error = error_of(rotor.at(kStart + seconds{s}).azimuth_rad, 2.0);
    square += error * error;
    worst = std::max(worst, error);
  }
  const double predicted = 0.157 * 0.4 * std::sqrt(0.5 / 0.9);
  EXPECT_NEAR(std::sqrt(square / kSeconds), predicted, 0.15 * predicted);
  EXPECT_LT(worst, 5.0 * predicted);
}

TEST(Rotor, ASpeedThatIsNoWholeNumberOfTurnsPerSecondDoesNotLock) {
  Rotor rotor(locked(10.5 * kTurn, 0.0));
  double worst = 0.0;
  for (int s = 10; s < 30; ++s) {
    worst = std::max(worst, error_of(rotor.at(kStart + seconds{s}).azimuth_rad, 0.0));
  }
  EXPECT_GT(worst, 10.0 * kDegree);
}

TEST(Rotor, RefusesNonsense) {
  const auto refused = [](const auto& change) {
    RotorParameters parameters;
    change(parameters);
    EXPECT_THROW(Rotor(LidarCommand{}, parameters), std::invalid_argument);
  };
  refused([](auto& p) { p.time_constant_s = 0.0; });
  refused([](auto& p) { p.acceleration_radps2 = std::nan(""); });
  refused([](auto& p) { p.wander_radps = -0.1; });
  refused([](auto& p) { p.wander_correlation_s = 0.0; });
  refused([](auto& p) { p.phase_time_s = 0.0; });
  refused([](auto& p) { p.phase_speed_share = 1.0; });
  EXPECT_THROW(Rotor(turning(501.0)), std::invalid_argument);
  EXPECT_THROW(Rotor(turning(std::nan(""))), std::invalid_argument);
  EXPECT_THROW(Rotor(locked(kRotorRate, std::nan(""))), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
