#include "sim/gnss/observations.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sim/local_frame.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::array kGps{GnssSystem::gps};

class ObservationsTest : public testing::Test {
 protected:
  /// One epoch of a moving antenna, `signals` tracked.
  const std::vector<GnssMeasurement>& measure(SimTime t, std::vector<TrackedSignal> signals) {
    epoch_ = clock_.measure(t);
    const Eigen::Vector3d v_W(3.0, -8.0, 0.5);
    const Eigen::Vector3d p_W = v_W * (to_seconds(t) + epoch_.measured_after_s);
    antenna_ = reception_point(calendar_.gps(t), epoch_, frame_.to_ecef(p_W),
                               frame_.world_from_ecef().transpose() * v_W);
    observations_.measure(*constellation_, t, epoch_, antenna_, signals, measurements_);
    return measurements_;
  }

  std::shared_ptr<const Constellation> constellation_ = make_nominal_constellation(kGps);
  Calendar calendar_{UtcTime{2024, 6, 1, 9, 59, 30, 0}};
  LocalFrame frame_{LocalFrameParameters{}};
  ReceiverClock clock_{{.drift = -1e-6, .wander_sigma = 0.0}, 4, "clock"};
  Observations observations_{24, 4, "ambiguity"};
  ClockEpoch epoch_;
  ReceptionPoint antenna_;
  std::vector<GnssMeasurement> measurements_;
};

TEST_F(ObservationsTest, CodeAndCarrierAreTheSumOfTheirParts) {
  TrackedSignal signal;
  signal.satellite = 6;
  signal.ionosphere_m = 4.0;
  signal.troposphere_m = 3.0;
  signal.code_error_m = 0.5;
  signal.carrier_error_m = 0.002;
  const GnssMeasurement m = measure(kStart, {signal}).front();
  const SignalPath path = signal_path(*constellation_, 6, antenna_);
  const double geometry_m =
      path.range_m + kLightSpeed_mps * (epoch_.bias_s - path.satellite_clock_s);
  EXPECT_EQ(m.system, GnssSystem::gps);
  EXPECT_EQ(m.number, 7);
  EXPECT_NEAR(m.pseudorange_m, geometry_m + kLightSpeed_mps * path.group_delay_s + 4.0 + 3.0 + 0.5,
              1e-6);
  const double cycles = (geometry_m - 4.0 + 3.0 + 0.002) / kGpsL1Wavelength_m;
  const double ambiguity = m.carrier_phase_cycles - cycles;
  EXPECT_NEAR(ambiguity, std::round(ambiguity), 1e-6);
  EXPECT_LE(std::abs(m.carrier_phase_cycles - m.pseudorange_m / kGpsL1Wavelength_m), 401.0);
}

// L2 of GPS: 60 / 77 of the frequency, so the ionosphere is stronger by (77 / 60)^2, and so is the
// satellite's group delay.
TEST_F(ObservationsTest, TheIonosphereIsStrongerOnTheLowerCarrier) {
  constexpr double kStronger = 77.0 * 77.0 / (60.0 * 60.0);
  TrackedSignal first;
  first.satellite = 6;
  first.ionosphere_m = 4.0;
  TrackedSignal second = first;
  second.second = true;
  const std::vector<GnssMeasurement> m = measure(kStart, {first, second});
  ASSERT_EQ(m.size(), 2U);
  EXPECT_FALSE(m[0].second);
  EXPECT_TRUE(m[1].second);
  const SignalPath path = signal_path(*constellation_, 6, antenna_);
  EXPECT_NEAR(m[1].pseudorange_m - m[0].pseudorange_m,
              (kStronger - 1.0) * (4.0 + kLightSpeed_mps * path.group_delay_s), 1e-6);
  const double geometry_m =
      path.range_m + kLightSpeed_mps * (epoch_.bias_s - path.satellite_clock_s);
  const double ambiguity =
      m[1].carrier_phase_cycles - (geometry_m - kStronger * 4.0) * 60.0 / 77.0 / kGpsL1Wavelength_m;
  EXPECT_NEAR(ambiguity, std::round(ambiguity), 1e-6);
  EXPECT_NEAR(m[1].doppler_hz, m[0].doppler_hz * 60.0 / 77.0, 1e-9);
}

TEST_F(ObservationsTest, CarrierMovesAsTheCodeAndAsTheDopplerSays) {
  // Across a change of the broadcast at 10:00:00 GPS and over a millisecond's reset of the clock.
  std::vector<TrackedSignal> signals(4);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    signals[i].satellite = 5 * i + 1;
  }
  std::vector<GnssMeasurement> before = measure(kStart, signals);
  Duration label = epoch_.label_offset;
  int resets = 0;
  for (SimTime t = kStart + 1s; t < kStart + 1'800s; t += 1s) {
    const std::vector<GnssMeasurement> now = measure(t, signals);
    resets += epoch_.reset ? 1 : 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double code_m = now[i].pseudorange_m - before[i].pseudorange_m;
      const double cycles = now[i].carrier_phase_cycles - before[i].carrier_phase_cycles;
      EXPECT_NEAR(code_m, cycles * kGpsL1Wavelength_m, 1e-6);
      // By the receiver's own clock; the reset is no motion.
      const double span_s =
          1.0 + to_seconds(epoch_.label_offset - label) - (epoch_.reset ? 1e-3 : 0.0);
      const double moved = cycles - (epoch_.reset ? 1'575'420.0 : 0.0);
      EXPECT_NEAR(-moved / span_s, 0.5 * (now[i].doppler_hz + before[i].doppler_hz), 2e-3);
      EXPECT_EQ(now[i].locked, t - kStart);
      EXPECT_FALSE(now[i].slipped);
    }
    before = now;
    label = epoch_.label_offset;
  }
  EXPECT_GE(resets, 1);
}

TEST_F(ObservationsTest, ASlipRedrawsTheAmbiguityOfThatSatelliteOnly) {
  std::vector<TrackedSignal> signals(2);
  signals[0].satellite = 3;
  signals[1].satellite = 9;
  const auto offset = [](const GnssMeasurement& m) {
    return m.carrier_phase_cycles - m.pseudorange_m / kGpsL1Wavelength_m;
  };
  const std::vector<GnssMeasurement> first = measure(kStart, signals);
  EXPECT_TRUE(first[0].slipped);
  EXPECT_EQ(first[0].locked, 0ns);
  signals[1].slipped = true;
  const std::vector<GnssMeasurement> second = measure(kStart + 1s, signals);
  EXPECT_NEAR(offset(second[0]), offset(first[0]), 1e-4);
  EXPECT_GT(std::abs(offset(second[1]) - offset(first[1])), 0.5);
  EXPECT_FALSE(second[0].slipped);
  EXPECT_TRUE(second[1].slipped);
  EXPECT_EQ(second[1].locked, 0ns);
}

TEST_F(ObservationsTest, AnAbsentSatelliteHasLostItsLock) {
  std::vector<TrackedSignal> signals(1);
  signals[0].satellite = 3;
  measure(kStart, signals);
  measure(kStart + 1s, {});
  EXPECT_TRUE(measure(kStart + 2s, signals).front().slipped);
  EXPECT_EQ(measure(kStart + 3s, signals).front().locked, 1s);
  observations_.lose_lock();
  EXPECT_TRUE(measure(kStart + 4s, signals).front().slipped);
}

TEST_F(ObservationsTest, SigmasFallWithTheSignalsStrength) {
  EXPECT_DOUBLE_EQ(code_sigma_m(45.0), 0.3);
  EXPECT_DOUBLE_EQ(code_sigma_m(25.0), 3.0);
  // sqrt(15 / 31623) / 2 pi of a cycle.
  EXPECT_NEAR(carrier_sigma_cycles(45.0), 0.00347, 1e-5);
  EXPECT_DOUBLE_EQ(doppler_sigma_hz(35.0), 0.1 * std::sqrt(10.0));
  TrackedSignal signal;
  signal.cn0_dbhz = 31.0;
  const GnssMeasurement m = measure(kStart, {signal}).front();
  EXPECT_EQ(m.cn0_dbhz, 31.0);
  EXPECT_EQ(m.pseudorange_sigma_m, code_sigma_m(31.0));
}

TEST_F(ObservationsTest, ApproachIsAPositiveDoppler) {
  TrackedSignal signal;
  for (std::size_t i = 0; i < 24; ++i) {
    signal.satellite = i;
    const GnssMeasurement m = measure(kStart + 1s * static_cast<int>(i), {signal}).front();
    const SignalPath path = signal_path(*constellation_, i, antenna_);
    EXPECT_NEAR(
        m.doppler_hz * kGpsL1Wavelength_m,
        -path.range_rate_mps - kLightSpeed_mps * (epoch_.drift - path.satellite_clock_drift), 1e-3);
  }
}

}  // namespace
}  // namespace rigwire::sim
