#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "fake_sky.h"
#include "sim/gnss/gnss_sensor.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

class FaultyGnss : public testing::Test {
 protected:
  FaultyGnss() { parameters_.error_model = ErrorModel::coloured; }
  GnssSensor with(const GnssFault& fault) {
    parameters_.faults = {fault};
    return {parameters_, calendar_, frame_, 1, "gnss"};
  }
  static GnssFault from_ten_to_twenty(decltype(GnssFault::what) what) { return {{10s, 10s}, what}; }
  GnssSample at(GnssSensor& gnss, Duration t) const {
    return gnss.sample(kStart + t, antenna_, kOpen);
  }
  Eigen::Vector3d position(const GnssSample& sample) const {
    return frame_.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m});
  }
  static int tracked(const GnssSample& sample) {
    return static_cast<int>(std::ranges::count(sample.satellites, true, &SatelliteView::tracked));
  }

  const FakeSky kOpen = open_sky();
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  LocalFrame frame_{{49.42, 7.75, 280.0, 48.0}};
  GnssParameters parameters_;
  LinkMotion antenna_;
};

TEST_F(FaultyGnss, AntennaFaultsAndOutagesLeaveNoSignalAndSaySo) {
  struct Case {
    decltype(GnssFault::what) what;
    AntennaState state;
  };
  for (const Case& c :
       {Case{OutageFault{}, AntennaState::ok}, Case{AntennaOpenFault{}, AntennaState::open},
        Case{AntennaShortFault{}, AntennaState::short_circuit}}) {
    GnssSensor gnss = with(from_ten_to_twenty(c.what));
    EXPECT_EQ(at(gnss, 9s).fix, GnssFix::three_d);
    const GnssSample during = at(gnss, 10s);
    EXPECT_EQ(during.fix, GnssFix::none);
    EXPECT_EQ(tracked(during), 0);
    EXPECT_EQ(during.radio.antenna, c.state);
    for (const SatelliteView& satellite : during.satellites) {
      EXPECT_EQ(satellite.cn0_dbhz, 0.0);
    }
    EXPECT_EQ(at(gnss, 20s).fix, GnssFix::none) << "signals are being acquired again";
    const GnssSample after = at(gnss, 21s + 500ms);
    EXPECT_EQ(after.fix, GnssFix::three_d);
    EXPECT_EQ(after.radio.antenna, AntennaState::ok);
  }
}

TEST_F(FaultyGnss, JammingTakesSignalsAccuracyAndThenTheFix) {
  parameters_.sky.cn0_sigma_db = 0.0;
  GnssSensor mild = with(from_ten_to_twenty(JammingFault{10.0}));
  const GnssSample before = at(mild, 9s);
  EXPECT_EQ(before.radio.jamming, 0.0);
  const GnssSample during = at(mild, 10s);
  EXPECT_NEAR(during.satellites.front().cn0_dbhz, before.satellites.front().cn0_dbhz - 10.0, 0.01);
  EXPECT_GT(during.radio.jamming, 0.5);
  EXPECT_EQ(during.radio.noise_db, 10.0);
  EXPECT_GT(during.horizontal_accuracy_m, before.horizontal_accuracy_m);
  GnssSensor heavy = with(from_ten_to_twenty(JammingFault{40.0}));
  (void)at(heavy, 9s);
  EXPECT_EQ(at(heavy, 10s).fix, GnssFix::none);
}

// A jammer of L2: the first signals and the fix stay; of L1: each second signal is the stronger
// one, as long as its satellite is held by the first.
TEST_F(FaultyGnss, AJammedBandLeavesTheOtherAlone) {
  parameters_.sky.cn0_sigma_db = 0.0;
  parameters_.sky.cn0_sigma_moving_db = 0.0;
  parameters_.raw_measurements = true;
  parameters_.second_signals = true;
  const auto strengths = [&](JammedBand band, double loss_db) {
    GnssSensor gnss = with(from_ten_to_twenty(JammingFault{.loss_db = loss_db, .band = band}));
    const GnssSample before = at(gnss, 9s);
    const GnssSample during = at(gnss, 10s);
    // Change of the first and of the second signal of the satellite that is heard best.
    std::array<double, 2> change_db{};
    std::array<std::size_t, 2> count{};
    for (const GnssMeasurement& m : during.measurements) {
      ++count[m.second ? 1 : 0];
    }
    for (const GnssMeasurement& m : before.measurements) {
      const auto same = std::ranges::find_if(during.measurements, [&](const GnssMeasurement& o) {
        return o.number == m.number && o.second == m.second;
      });
      if (same != during.measurements.end()) {
        change_db[m.second ? 1 : 0] = same->cn0_dbhz - m.cn0_dbhz;
      }
    }
    return std::tuple(change_db, count, during);
  };
  const auto [second_db, second_count, second] = strengths(JammedBand::l2, 10.0);
  EXPECT_NEAR(second_db[0], 0.0, 0.05);
  EXPECT_NEAR(second_db[1], -10.0, 0.05);
  EXPECT_GE(second_count[0], second_count[1]);
  EXPECT_GE(second_count[1] + 2, second_count[0]) << "the lowest ones are too weak then";
  EXPECT_EQ(second.radio.jamming, 0.0);
  EXPECT_EQ(second.radio.noise_db, 0.0);
  EXPECT_EQ(second.radio.second_noise_db, 10.0);
  const auto [first_db, first_count, first] = strengths(JammedBand::l1, 10.0);
  EXPECT_NEAR(first_db[0], -10.0, 0.05);
  EXPECT_NEAR(first_db[1], 0.0, 0.05);
  EXPECT_EQ(first.radio.noise_db, 10.0);
  EXPECT_EQ(first.radio.second_jamming, 0.0);
  const auto [deaf_db, deaf_count, deaf] = strengths(JammedBand::l2, 60.0);
  EXPECT_GT(deaf_count[0], 4U);
  EXPECT_EQ(deaf_count[1], 0U);
  EXPECT_EQ(deaf.fix, GnssFix::three_d);
  const auto [both_db, both_count, both] = strengths(JammedBand::all, 10.0);
  EXPECT_NEAR(both_db[0], -10.0, 0.05);
  EXPECT_NEAR(both_db[1], -10.0, 0.05);
}

TEST_F(FaultyGnss, ASpoofedReceiverDriftsOffWithStrongConsistentSignals) {
  const Eigen::Vector3d velocity_mps(3.0, -4.0, 0.5);
  GnssSensor spoofed = with(from_ten_to_twenty(SpoofDriftFault{velocity_mps, 30.0}));
  GnssSensor honest(parameters_, calendar_, frame_, 1, "gnss");
  const GnssSample during = at(spoofed, 18s);
  parameters_.faults.clear();
  GnssSensor truthful(parameters_, calendar_, frame_, 1, "gnss");
  const GnssSample truth = at(truthful, 18s);
  const Eigen::Vector3d away = position(during) - velocity_mps * 8.0;
  EXPECT_LT(away.norm(), 15.0) << "24 m east, 32 m south, and its own noise";
  EXPECT_NEAR(during.velocity_ned_mps.x, -4.0, 0.4);
  EXPECT_NEAR(during.velocity_ned_mps.y, 3.0, 0.4);
  EXPECT_NEAR(during.clock_bias_s - truth.clock_bias_s, 240.0 / kLightSpeed_mps, 1e-7);
  EXPECT_NEAR(during.clock_drift - truth.clock_drift, 30.0 / kLightSpeed_mps, 1e-12);
  for (const SatelliteView& satellite : during.satellites) {
    EXPECT_TRUE(satellite.tracked);
    EXPECT_NEAR(satellite.cn0_dbhz, 50.0, 2.0) << "evenly strong, also at the horizon";
    EXPECT_LT(std::abs(satellite.residual_m), 15.0);
  }
}

TEST_F(FaultyGnss, SpoofedSignalsReachIndoors) {
  GnssSensor gnss = with(from_ten_to_twenty(SpoofDriftFault{}));
  const FakeSky indoors = closed_sky();
  EXPECT_EQ(gnss.sample(kStart + 5s, antenna_, indoors).fix, GnssFix::none);
  (void)gnss.sample(kStart + 10s, antenna_, indoors);
  EXPECT_EQ(gnss.sample(kStart + 12s, antenna_, indoors).fix, GnssFix::three_d);
}

TEST_F(FaultyGnss, AJumpMovesThePositionAtOnceAndBack) {
  const Eigen::Vector3d offset_m(100.0, 50.0, -20.0);
  GnssSensor gnss = with(from_ten_to_twenty(JumpFault{offset_m}));
  const Eigen::Vector3d before = position(at(gnss, 10s - 100ms));
  const Eigen::Vector3d during = position(at(gnss, 10s));
  const Eigen::Vector3d after = position(at(gnss, 20s));
  EXPECT_LT((during - before - offset_m).norm(), 3.0);
  EXPECT_LT((after - before).norm(), 10.0);
}

TEST_F(FaultyGnss, WithoutCorrectionsRtkEndsWithTheirLargestAge) {
  parameters_.corrections.kind = CorrectionKind::assumed_rtk;
  parameters_.corrections.first_fix_s = 2.0;
  parameters_.corrections.largest_age_s = 5.0;
  GnssSensor gnss = with(from_ten_to_twenty(CorrectionOutageFault{}));
  for (int t = 1; t < 10; ++t) {
    (void)at(gnss, t * 1s);
  }
  EXPECT_EQ(at(gnss, 11s).carrier, CarrierSolution::fixed);
  EXPECT_GT(*at(gnss, 13s).differential_age_s, 3.0);
  const GnssSample old = at(gnss, 18s);
  EXPECT_EQ(old.carrier, CarrierSolution::none);
  EXPECT_FALSE(old.differential);
  EXPECT_EQ(old.fix, GnssFix::three_d) << "the code position goes on";
}

}  // namespace
}  // namespace rigwire::sim
