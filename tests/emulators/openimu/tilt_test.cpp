#include "emulators/inertial/filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace openimu = protocols::openimu;

constexpr double kTiltRadians = std::numbers::pi / 180.0;

TEST(OpenImuTilt, FollowsAMovingBoomByItsRates) {
  // Pitch swings +-30 deg with 4 s period; the filter has rates and gravity, no truth.
  OpenImuRig rig;
  rig.run(2s);
  double worst = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 0.005;
    const double w = std::numbers::pi / 2.0;
    const double pitch = 30.0 * kTiltRadians * std::sin(w * t);
    ImuSample sample = level(rig.now);
    sample.specific_force_mps2 = {kGravity * std::sin(pitch), 0.0, kGravity * std::cos(pitch)};
    sample.angular_rate_radps.y = -30.0 * kTiltRadians * w * std::cos(w * t);
    rig.imu.update(sample);
    rig.now += OpenImu::kTick;
    if (i > 200 && i % 2 == 0) {
      const auto slope = openimu::decode<openimu::Slope>(rig.output.of(openimu::kSlopePgn).back());
      worst = std::max(worst, std::abs(slope->pitch_deg - pitch / kTiltRadians));
    }
    rig.output.frames.erase(rig.output.frames.begin(), rig.output.frames.end() - 3);
  }
  // The 25 Hz low-pass delays by 9 ms; at 47 deg/s that is 0.42 deg.
  EXPECT_LT(worst, 0.6);
}

TEST(OpenImuTilt, TurnOnBiasIsLearnt) {
  OpenImuRig rig;
  ImuSample sample = level();
  sample.angular_rate_radps.y = 0.5 * kTiltRadians;
  rig.run(5s, sample);
  const double early =
      openimu::decode<openimu::Slope>(rig.output.of(openimu::kSlopePgn).back())->pitch_deg;
  EXPECT_LT(std::abs(early), 0.5 * TiltFilter::kTimeConstant_s);
  rig.run(120s, sample);
  const double late =
      openimu::decode<openimu::Slope>(rig.output.of(openimu::kSlopePgn).back())->pitch_deg;
  EXPECT_LT(std::abs(late), 0.05);
}

TEST(OpenImuTilt, DigShocksDoNotTiltIt) {
  OpenImuRig rig;
  rig.run(2s);
  ImuSample shock = level();
  shock.specific_force_mps2.x = 8.0;  // half a second at almost 1 g forwards
  rig.run(500ms, shock);
  const auto slope = openimu::decode<openimu::Slope>(rig.output.of(openimu::kSlopePgn).back());
  EXPECT_LT(std::abs(slope->pitch_deg), 0.5);
}

TEST(OpenImuLowPass, CutOffIsMinusThreeDecibels) {
  for (const double cut_off_hz : {5.0, 25.0, 50.0}) {
    LowPass filter(cut_off_hz, 200.0);
    double power = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const double phase = 2.0 * std::numbers::pi * cut_off_hz * i / 200.0 + 0.3;
      const double y = filter.filter({std::sin(phase), 0.0, 0.0})[0];
      power += i >= 2000 ? y * y : 0.0;
    }
    EXPECT_NEAR(power / 2000.0, 0.25, 1e-3) << cut_off_hz;  // half of 1/2
  }
}

TEST(OpenImuLowPass, StartsSettled) {
  LowPass filter(2.0, 200.0);
  EXPECT_NEAR(filter.filter({9.81, -1.0, 0.0})[0], 9.81, 1e-12);
  EXPECT_NEAR(filter.filter({9.81, -1.0, 0.0})[0], 9.81, 1e-12);
}

}  // namespace
}  // namespace rigwire::emulators
