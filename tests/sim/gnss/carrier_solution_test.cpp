#include "sim/gnss/carrier_solution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

CorrectionParameters of(CorrectionKind kind) {
  CorrectionParameters parameters;
  parameters.kind = kind;
  return parameters;
}

CorrectionInput good(SimTime time, int line_of_sight = 8) {
  return {.time = time,
          .carriers = {line_of_sight, line_of_sight, line_of_sight, 0},
          .has_position = true,
          .link = true};
}

TEST(CarrierEngine, WithoutCorrectionsNothingHappens) {
  CarrierEngine engine(of(CorrectionKind::none), 1, "gnss");
  const CorrectionOutput output = engine.advance(good(kStart + 10s));
  EXPECT_EQ(output.carrier, CarrierSolution::none);
  EXPECT_FALSE(output.differential);
  EXPECT_FALSE(output.age_s);
  EXPECT_FALSE(output.error_ned_m);
}

TEST(CarrierEngine, FloatsThenFixesThenLosesAndFindsTheFixAgain) {
  CarrierEngine engine(of(CorrectionKind::assumed_rtk), 1, "gnss");
  SimTime now = kStart + 10s;
  EXPECT_EQ(engine.advance(good(now)).carrier, CarrierSolution::floating);
  EXPECT_EQ(engine.advance(good(now + 29s)).carrier, CarrierSolution::floating);
  CorrectionOutput output = engine.advance(good(now + 30s));
  EXPECT_EQ(output.carrier, CarrierSolution::fixed);
  // 1 cm + 0.5 mm radial at 500 m from the base.
  EXPECT_NEAR(std::sqrt(2.0) * output.horizontal_sigma_m, 0.0105, 1e-9);
  EXPECT_NEAR(output.vertical_sigma_m, 0.0205, 1e-9);

  now += 40s;
  EXPECT_EQ(engine.advance(good(now, 5)).carrier, CarrierSolution::fixed);
  EXPECT_EQ(engine.advance(good(now + 1s, 4)).carrier, CarrierSolution::floating);
  now += 2s;
  double refixed_s = 0.0;
  while (engine.advance(good(now)).carrier != CarrierSolution::fixed) {
    now += 100ms;
    refixed_s += 0.1;
    ASSERT_LT(refixed_s, 31.0);
  }
  EXPECT_GE(refixed_s, 4.9);
  EXPECT_EQ(engine.advance(good(now + 1s, 3)).carrier, CarrierSolution::none);
}

TEST(CarrierEngine, FloatErrorDecaysBetweenItsBounds) {
  CorrectionParameters parameters = of(CorrectionKind::assumed_rtk);
  parameters.first_fix_s = 1000.0;
  CarrierEngine engine(parameters, 1, "gnss");
  const SimTime start = kStart + 10s;
  EXPECT_NEAR(engine.advance(good(start)).horizontal_sigma_m, 1.0, 1e-9);
  EXPECT_NEAR(engine.advance(good(start + 20s)).horizontal_sigma_m, 0.2 + 0.8 * std::exp(-1.0),
              1e-9);
  EXPECT_NEAR(engine.advance(good(start + 500s)).horizontal_sigma_m, 0.2, 1e-6);
}

TEST(CarrierEngine, AgeIsASawToothAndGrowsWithoutALink) {
  CarrierEngine engine(of(CorrectionKind::assumed_rtk), 1, "gnss");
  EXPECT_NEAR(*engine.advance(good(kStart + 100s + 600ms)).age_s, 0.6, 1e-9);
  EXPECT_NEAR(*engine.advance(good(kStart + 101s + 500ms)).age_s, 1.5, 1e-9);
  EXPECT_NEAR(*engine.advance(good(kStart + 101s + 600ms)).age_s, 0.6, 1e-9);
  CorrectionInput cut = good(kStart + 150s);
  cut.link = false;
  EXPECT_NEAR(*engine.advance(cut).age_s, 49.0, 1e-9);
  cut.time = kStart + 162s;
  const CorrectionOutput output = engine.advance(cut);
  EXPECT_FALSE(output.differential) << "older than a minute";
  EXPECT_FALSE(output.age_s);
  EXPECT_EQ(output.carrier, CarrierSolution::none);
}

TEST(CarrierEngine, TheErrorHasTheSizeOfItsState) {
  CorrectionParameters parameters = of(CorrectionKind::assumed_rtk);
  parameters.correlation_s = 1.0;
  CarrierEngine engine(parameters, 1, "gnss");
  double square = 0.0;
  int count = 0;
  for (int t = 0; t < 10'000; ++t) {
    const CorrectionOutput output = engine.advance(good(kStart + 10s + t * 2s));
    if (output.carrier == CarrierSolution::fixed) {
      square += output.error_ned_m->head<2>().squaredNorm();
      ++count;
    }
  }
  EXPECT_NEAR(std::sqrt(square / count), 0.0105, 0.0003);
}

TEST(CarrierEngine, AServiceConvergesToCentimetresAndBridgesShortLosses) {
  CarrierEngine engine(of(CorrectionKind::service), 1, "gnss");
  const SimTime start = kStart + 10s;
  EXPECT_NEAR(engine.advance(good(start)).horizontal_sigma_m, 1.0, 1e-9);
  EXPECT_NEAR(std::sqrt(2.0) * engine.advance(good(start + 3600s)).horizontal_sigma_m, 0.05, 0.002);
  EXPECT_EQ(engine.advance(good(start + 3601s, 2)).carrier, CarrierSolution::none);
  EXPECT_LT(engine.advance(good(start + 3630s)).horizontal_sigma_m, 0.05);
  EXPECT_EQ(engine.advance(good(start + 3700s, 2)).carrier, CarrierSolution::none);
  EXPECT_NEAR(engine.advance(good(start + 3800s)).horizontal_sigma_m, 1.0, 1e-9);
}

TEST(CarrierEngine, SbasShrinksWhatItKnowsAbout) {
  CarrierEngine engine(of(CorrectionKind::sbas), 1, "gnss");
  CorrectionInput input = good(kStart + 10s);
  input.link = false;
  EXPECT_EQ(engine.advance(input).share.orbit_clock, 1.0);
  const CorrectionOutput output = engine.advance(good(kStart + 11s));
  EXPECT_TRUE(output.differential);
  EXPECT_LT(output.share.orbit_clock, 1.0);
  EXPECT_LT(output.share.ionosphere, 1.0);
  EXPECT_EQ(output.carrier, CarrierSolution::none);
}

TEST(CarrierEngine, RefusesStrangeParameters) {
  CorrectionParameters parameters;
  parameters.kind =
      CorrectionKind::assumed_rtk;  // the figures of what does not arrive have no effect
  parameters.refix_shortest_s = 40.0;
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  parameters = {};
  parameters.kind = CorrectionKind::sbas;
  parameters.interval_s = 0.0;
  EXPECT_THROW(validate(parameters), std::invalid_argument);
}

CorrectionInput received(SimTime time, const ReceivedCorrections& corrections) {
  CorrectionInput input = good(time);
  input.received = corrections;
  input.received->measured = time - 1s;
  return input;
}

/// Seconds from the first correction to a fix, at 1 Hz; 1000 when there is none.
double time_to_fix_s(std::uint64_t seed, const ReceivedCorrections& corrections) {
  CarrierEngine engine(of(CorrectionKind::rtk), seed, "gnss");
  for (int second = 1; second < 1000; ++second) {
    const auto output =
        engine.advance(received(kStart + std::chrono::seconds(second), corrections));
    if (output.carrier == CarrierSolution::fixed) {
      return second;
    }
  }
  return 1000.0;
}

double mean_time_to_fix_s(const ReceivedCorrections& corrections) {
  constexpr int kSeeds = 200;
  double sum_s = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    sum_s += time_to_fix_s(seed, corrections);
  }
  return sum_s / kSeeds;
}

constexpr ReceivedCorrections kGood{
    .baseline_m = 1000.0, .common = {14, 14, 14, 12}, .carriers_agree = true};

// Data sheets: a ZED-F9P below 10 s with several systems, below 30 s with GPS alone; a NEO-M8P,
// which has one band, below 60 s.
TEST(CarrierEngineByPort, TimesToFixAreThoseOfDataSheets) {
  EXPECT_NEAR(mean_time_to_fix_s(kGood), 9.5, 1.0) << "with two epochs to float";
  ReceivedCorrections gps = kGood;
  gps.gps_only = true;
  EXPECT_NEAR(mean_time_to_fix_s(gps), 24.0, 2.0);
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    EXPECT_LE(time_to_fix_s(seed, kGood), 12.0) << "10 s and two epochs";
    EXPECT_LE(time_to_fix_s(seed, gps), 30.0);
  }
  ReceivedCorrections one_band = kGood;
  one_band.common.two_band = 0;
  EXPECT_NEAR(mean_time_to_fix_s(one_band), 34.0, 5.0);
  ReceivedCorrections far = kGood;
  far.baseline_m = 15e3;
  EXPECT_NEAR(mean_time_to_fix_s(far) / mean_time_to_fix_s(kGood), 1.8, 0.3);
}

TEST(CarrierEngineByPort, WhatIsMissingHoldsTheFixBack) {
  const auto never = [](auto change) {
    ReceivedCorrections corrections = kGood;
    change(corrections);
    return time_to_fix_s(1, corrections) == 1000.0;
  };
  EXPECT_FALSE(never([](ReceivedCorrections&) {}));
  EXPECT_TRUE(never([](ReceivedCorrections& c) { c.common.held = 4; }));
  EXPECT_FALSE(never([](ReceivedCorrections& c) { c.common.held = 12; }));
  EXPECT_TRUE(never([](ReceivedCorrections& c) { c.common.held = 6; })) << "of 14 used";
  EXPECT_TRUE(never([](ReceivedCorrections& c) { c.carriers_agree = false; }));
  EXPECT_TRUE(never([](ReceivedCorrections& c) { c.floating_only = true; }));
  EXPECT_TRUE(never([](ReceivedCorrections& c) { c.baseline_m = 51e3; }));
  EXPECT_TRUE(never([](ReceivedCorrections& c) {
    c.baseline_m = 16e3;
    c.common.two_band = 4;
  }));
}

// Before: one bad epoch of the base cost 5 to 30 s, and the float's error began at its own size.
TEST(CarrierEngineByPort, IntegersAreRememberedWhileCarriersAreHeld) {
  const auto refixed_s = [](int held, int used) {
    CarrierEngine engine(of(CorrectionKind::rtk), 5, "gnss");
    SimTime now = kStart + 1s;
    CorrectionOutput output = engine.advance(received(now, kGood));
    while (output.carrier != CarrierSolution::fixed) {
      now += 1s;
      output = engine.advance(received(now, kGood));
    }
    const Eigen::Vector3d before_m = *output.error_ned_m;
    ReceivedCorrections bad = kGood;
    bad.carriers_agree = false;
    bad.common.held = held;
    bad.common.used = used;
    now += 1s;
    output = engine.advance(received(now, bad));
    EXPECT_EQ(output.carrier, CarrierSolution::floating);
    EXPECT_LT((*output.error_ned_m - before_m).norm(), 0.03) << "it floats on from its place";
    int seconds = 0;
    while (output.carrier != CarrierSolution::fixed && seconds < 60) {
      now += 1s;
      ++seconds;
      output = engine.advance(received(now, kGood));
    }
    return seconds;
  };
  EXPECT_EQ(refixed_s(14, 14), 2) << "the first good epoch, and a second";
  EXPECT_EQ(refixed_s(4, 7), 2);
  EXPECT_GE(refixed_s(3, 6), 6);
  EXPECT_GE(refixed_s(6, 14), 6) << "most of them slipped";
}

// A float after a fix moves away from it, and says so.
TEST(CarrierEngineByPort, AFloatAfterAFixBecomesWorseSteadily) {
  CarrierEngine engine(of(CorrectionKind::rtk), 5, "gnss");
  SimTime now = kStart + 1s;
  CorrectionOutput output = engine.advance(received(now, kGood));
  while (output.carrier != CarrierSolution::fixed) {
    now += 1s;
    output = engine.advance(received(now, kGood));
  }
  ReceivedCorrections bad = kGood;
  bad.carriers_agree = false;
  double level_m = output.horizontal_sigma_m;
  for (int i = 0; i < 100; ++i) {
    now += 1s;
    output = engine.advance(received(now, bad));
    EXPECT_GE(output.horizontal_sigma_m, level_m);
    level_m = output.horizontal_sigma_m;
  }
  EXPECT_NEAR(level_m, 0.2, 0.01);
}

TEST(CarrierEngineByPort, NothingReceivedIsNothing) {
  CarrierEngine engine(of(CorrectionKind::rtk), 1, "gnss");
  for (int second = 1; second < 100; ++second) {
    const auto output = engine.advance(good(kStart + std::chrono::seconds(second)));
    EXPECT_EQ(output.carrier, CarrierSolution::none);
    EXPECT_FALSE(output.differential || output.age_s);
  }
}

// A second base station far away: 1 ppm of 30 km, and 3 cm per minute of age.
TEST(CarrierEngineByPort, ErrorGrowsWithBaselineAndAge) {
  ReceivedCorrections corrections = kGood;
  corrections.baseline_m = 30e3;
  CarrierEngine engine(of(CorrectionKind::rtk), 3, "gnss");
  SimTime now = kStart + 1s;
  CorrectionOutput output = engine.advance(received(now, corrections));
  while (output.carrier != CarrierSolution::fixed) {
    now += 1s;
    ASSERT_LT(now, kStart + 300s);
    output = engine.advance(received(now, corrections));
  }
  EXPECT_NEAR(output.horizontal_sigma_m * std::sqrt(2.0), 0.01 + 0.03 + 0.0005, 1e-9);
  CorrectionInput old = received(now, corrections);
  old.time = now + 19s;
  EXPECT_NEAR(engine.advance(old).horizontal_sigma_m * std::sqrt(2.0), 0.01 + 0.03 + 0.01, 1e-9);
  old.time = now + 31s;
  EXPECT_EQ(engine.advance(old).carrier, CarrierSolution::floating);
  old.time = now + 60s;
  EXPECT_FALSE(engine.advance(old).differential);
}

}  // namespace
}  // namespace rigwire::sim
