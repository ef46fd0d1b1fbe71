#include "emulators/openimu335ri.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "emulators/can_bus.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using protocols::openimu::FigureOfMerit;
using testing::ElementsAre;
namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;

constexpr double kGravity = 9.80665;
constexpr double kRadians = std::numbers::pi / 180.0;
constexpr std::uint8_t kTester = 0x21;

struct Recorder final : FrameOutput {
  void send(SimTime due, const Frame& frame) override {
    EXPECT_GE(due, last);
    last = due;
    frames.emplace_back(due, frame);
  }
  /// Frames of one group, oldest first.
  [[nodiscard]] std::vector<Frame> of(std::uint32_t pgn) const {
    std::vector<Frame> result;
    for (const auto& [due, frame] : frames) {
      if (j1939::unpack(frame.id).pgn == pgn) {
        result.push_back(frame);
      }
    }
    return result;
  }
  SimTime last = kStart;
  std::vector<std::pair<SimTime, Frame>> frames;
};

ImuSample level(SimTime time = kStart) {
  return {time, {0.0, 0.0, kGravity}, {0.0, 0.0, 0.0}, 25.0};
}

OpenImuSettings settings_with(std::uint32_t serial,
                              OpenImuVariant variant = OpenImuVariant::openimu335ri) {
  OpenImuSettings settings;
  settings.serial = serial;
  settings.variant = variant;
  return settings;
}

/// A device with its ticks, fed with one constant sample.
struct Rig {
  explicit Rig(const OpenImuSettings& settings = settings_with(0x12340)) : imu(settings, output) {}

  void run(Duration span, ImuSample sample = level()) {
    for (const SimTime end = now + span; now < end; now += OpenImu::kTick) {
      sample.time = now;
      imu.update(sample);
    }
  }
  void receive(const Frame& frame) { imu.receive(now, frame); }

  Recorder output;
  OpenImu imu;
  SimTime now = kStart;
};

TEST(OpenImu, ClaimsAfterItsSerialDelayAndSendsNothingBefore) {
  Rig rig(settings_with(0x12345));  // 5 * 5 ms
  rig.run(100ms);
  ASSERT_FALSE(rig.output.frames.empty());
  const auto& [due, claim] = rig.output.frames.front();
  EXPECT_EQ(due, kStart + 25ms + 1ms);
  EXPECT_EQ(claim.id, 0x18EEFF80U);
  EXPECT_THAT(claim.payload(), ElementsAre(0x45, 0x23, 0xE1, 0x66, 0x00, 0x83, 0x00, 0x80));
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).size(), 1U);
}

TEST(OpenImu, ClaimsWithoutSamplesToo) {
  Recorder output;
  OpenImu imu(settings_with(3), output);
  EXPECT_EQ(imu.next_event(), kStart + 15ms);
  imu.advance(kStart + 14ms);
  EXPECT_TRUE(output.frames.empty());
  imu.advance(kStart + 1s);
  EXPECT_EQ(output.frames.size(), 1U);
  EXPECT_EQ(imu.next_event(), kNever);
}

TEST(OpenImu, AllThreeMessagesAt100HzByDefault) {
  Rig rig;
  rig.run(1s);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).size(), 100U);
  EXPECT_EQ(rig.output.of(openimu::kAngularRatePgn).size(), 100U);
  EXPECT_EQ(rig.output.of(openimu::kAccelerationPgn).size(), 100U);
}

TEST(OpenImu, RestBytesOfThe300RiAreTheKnownFrames) {
  Rig rig(settings_with(0x12345, OpenImuVariant::openimu300ri));
  ImuSample rest = level();
  rest.specific_force_mps2.z = 9.81;
  rig.run(20ms, rest);
  EXPECT_THAT(rig.output.of(openimu::kSlopePgn).back().payload(),
              ElementsAre(0x00, 0x00, 0x7D, 0x00, 0x00, 0x7D, 0xCC, 0x00));
  EXPECT_THAT(rig.output.of(openimu::kAngularRatePgn).back().payload(),
              ElementsAre(0x00, 0x7D, 0x00, 0x7D, 0x00, 0x7D, 0x3F, 0x00));
  EXPECT_THAT(rig.output.of(openimu::kAccelerationPgn).back().payload(),
              ElementsAre(0x00, 0x7D, 0x00, 0x7D, 0xD5, 0x80, 0xBF, 0x00));
}

TEST(OpenImu, HealthyMeritOfThe335RiAfterInitialisation) {
  Rig rig;
  rig.run(500ms);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).back().data[6], 0b0100'0100);  // degraded
  rig.run(1s);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).back().data[6], 0x00);
  EXPECT_EQ(rig.output.of(openimu::kAngularRatePgn).back().data[6], 0x00);
  EXPECT_EQ(rig.output.of(openimu::kAccelerationPgn).back().data[6], 0x80);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).back().data[7], 2);  // 1 ms
}

TEST(OpenImu, Claim300RiRepeatsEverySecond) {
  Rig rig(settings_with(0x12345, OpenImuVariant::openimu300ri));
  rig.run(3s);
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).size(), 3U);
}

TEST(OpenImuSigns, NoseUpRightDownClockwise) {
  Rig rig;
  ImuSample sample = level();
  const double pitch = 20.0 * kRadians;
  const double roll = 10.0 * kRadians;
  sample.specific_force_mps2 = {kGravity * std::sin(pitch),
                                kGravity * std::cos(pitch) * std::sin(roll),
                                kGravity * std::cos(pitch) * std::cos(roll)};
  rig.run(2s, sample);
  const auto slope = openimu::decode_slope(rig.output.of(openimu::kSlopePgn).back());
  EXPECT_NEAR(slope->pitch_deg.value, 20.0, openimu::kSlopeScale_deg);
  EXPECT_NEAR(slope->roll_deg.value, 10.0, openimu::kSlopeScale_deg);

  sample.angular_rate_radps = {3.0 * kRadians, -5.0 * kRadians, -7.0 * kRadians};
  rig.run(1s, sample);
  const auto rate = openimu::decode_angular_rate(rig.output.of(openimu::kAngularRatePgn).back());
  EXPECT_NEAR(rate->pitch_dps.value, 5.0, openimu::kRateScale_dps);
  EXPECT_NEAR(rate->roll_dps.value, 3.0, openimu::kRateScale_dps);
  EXPECT_NEAR(rate->yaw_dps.value, 7.0, openimu::kRateScale_dps);
}

TEST(OpenImuSigns, AccelerationIsLeftForwardUp) {
  Rig rig;
  ImuSample sample = level();
  sample.specific_force_mps2 = {1.5, 2.5, 9.0};
  rig.run(1s, sample);
  const auto force = openimu::decode_acceleration(rig.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->longitudinal_mps2.value, 1.5, 0.005 + 1e-9);
  EXPECT_NEAR(force->lateral_mps2.value, 2.5, 0.005 + 1e-9);
  EXPECT_NEAR(force->vertical_mps2.value, 9.0, 0.005 + 1e-9);
}

TEST(OpenImuTilt, FollowsAMovingBoomByItsRates) {
  // Pitch swings +-30 deg with 4 s period; the filter has rates and gravity, no truth.
  Rig rig;
  rig.run(2s);
  double worst = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = i * 0.005;
    const double w = std::numbers::pi / 2.0;
    const double pitch = 30.0 * kRadians * std::sin(w * t);
    ImuSample sample = level(rig.now);
    sample.specific_force_mps2 = {kGravity * std::sin(pitch), 0.0, kGravity * std::cos(pitch)};
    sample.angular_rate_radps.y = -30.0 * kRadians * w * std::cos(w * t);
    rig.imu.update(sample);
    rig.now += OpenImu::kTick;
    if (i > 200 && i % 2 == 0) {
      const auto slope = openimu::decode_slope(rig.output.of(openimu::kSlopePgn).back());
      worst = std::max(worst, std::abs(slope->pitch_deg.value - pitch / kRadians));
    }
    rig.output.frames.erase(rig.output.frames.begin(), rig.output.frames.end() - 3);
  }
  // The 25 Hz low-pass delays by 9 ms; at 47 deg/s that is 0.42 deg.
  EXPECT_LT(worst, 0.6);
}

TEST(OpenImuTilt, TurnOnBiasIsLearnt) {
  Rig rig;
  ImuSample sample = level();
  sample.angular_rate_radps.y = 0.5 * kRadians;
  rig.run(5s, sample);
  const double early =
      openimu::decode_slope(rig.output.of(openimu::kSlopePgn).back())->pitch_deg.value;
  EXPECT_LT(std::abs(early), 0.5 * TiltFilter::kTimeConstant_s);
  rig.run(120s, sample);
  const double late =
      openimu::decode_slope(rig.output.of(openimu::kSlopePgn).back())->pitch_deg.value;
  EXPECT_LT(std::abs(late), 0.05);
}

TEST(OpenImuTilt, DigShocksDoNotTiltIt) {
  Rig rig;
  rig.run(2s);
  ImuSample shock = level();
  shock.specific_force_mps2.x = 8.0;  // half a second at almost 1 g forwards
  rig.run(500ms, shock);
  const auto slope = openimu::decode_slope(rig.output.of(openimu::kSlopePgn).back());
  EXPECT_LT(std::abs(slope->pitch_deg.value), 0.5);
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

TEST(OpenImuSaturation, RateBeyondTheMessageIsClampedAndDegraded) {
  Rig rig;
  rig.run(2s);
  ImuSample fast = level();
  fast.angular_rate_radps.z = -300.0 * kRadians;
  rig.run(1s, fast);
  const auto rate = openimu::decode_angular_rate(rig.output.of(openimu::kAngularRatePgn).back());
  EXPECT_EQ(rate->yaw_dps.value, 250.0);
  EXPECT_EQ(rate->yaw_dps.merit, FigureOfMerit::degraded);
  EXPECT_EQ(rate->pitch_dps.merit, FigureOfMerit::functional);
}

TEST(OpenImuSaturation, ForceBeyondTheElementIsClampedAndDegraded) {
  Rig rig;
  rig.run(2s);
  ImuSample hit = level();
  hit.specific_force_mps2.x = 500.0;
  rig.run(1s, hit);
  const auto force = openimu::decode_acceleration(rig.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->longitudinal_mps2.value, 8.0 * kGravity, 0.01);
  EXPECT_EQ(force->longitudinal_mps2.merit, FigureOfMerit::degraded);
  EXPECT_EQ(force->lateral_mps2.merit, FigureOfMerit::functional);
}

TEST(OpenImuFault, SampleThatIsNoNumberIsSentAsErrorAndForgotten) {
  Rig rig;
  rig.run(2s);
  ImuSample broken = level();
  broken.specific_force_mps2.x = std::numeric_limits<double>::quiet_NaN();
  rig.run(20ms, broken);
  const Frame frame = rig.output.of(openimu::kAccelerationPgn).back();
  EXPECT_EQ(frame.data[1], 0xFE);
  EXPECT_EQ(frame.data[6], 0b1010'1010);
  rig.run(1s);
  const auto force = openimu::decode_acceleration(rig.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->vertical_mps2.value, kGravity, 0.006);
}

TEST(OpenImuAddress, LowerOwnNameClaimsAgain) {
  Rig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x80, std::numeric_limits<std::uint64_t>::max()));
  EXPECT_EQ(rig.imu.address(), 0x80);
  EXPECT_EQ(rig.output.frames.back().second, j1939::make_address_claim(0x80, rig.imu.name()));
  EXPECT_EQ(rig.imu.address_conflicts(), 1U);
}

TEST(OpenImuAddress, HigherOwnNameTakesTheNextFreeAddress) {
  Rig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x81, 2));
  rig.receive(j1939::make_address_claim(0x80, 1));
  EXPECT_EQ(rig.imu.address(), 0x82);
  EXPECT_EQ(rig.output.frames.back().second, j1939::make_address_claim(0x82, rig.imu.name()));
  rig.run(20ms);
  EXPECT_EQ(j1939::unpack(rig.output.of(openimu::kSlopePgn).back().id).source, 0x82);
}

TEST(OpenImuAddress, AvoidsWhatALowerNameHeldBeforeItsOwnFirstClaim) {
  Rig rig(settings_with(0x1234F));
  rig.receive(j1939::make_address_claim(0x80, 1));
  rig.run(200ms);
  EXPECT_EQ(rig.imu.address(), 0x81);
  EXPECT_EQ(rig.imu.address_conflicts(), 0U);
}

TEST(OpenImuAddress, FallsSilentWhenThePoolIsFull) {
  Rig rig;
  rig.run(50ms);
  for (unsigned address = 128; address <= 247; ++address) {
    rig.receive(j1939::make_address_claim(static_cast<std::uint8_t>(address), address));
  }
  EXPECT_FALSE(rig.imu.address_held());
  const std::size_t before = rig.output.frames.size();
  rig.run(100ms);
  rig.receive(j1939::make_request(kTester, j1939::kGlobalAddress, j1939::kAddressClaimedPgn));
  EXPECT_EQ(rig.output.frames.size(), before);
}

TEST(OpenImuAddress, TwoDevicesOnOneBusSortThemselvesOut) {
  Recorder outside;
  CanBusModel bus(CanBusSettings{});
  FrameOutput& first_output = bus.add_node(outside);
  FrameOutput& second_output = bus.add_node(outside);
  OpenImu first(settings_with(0x20), first_output);
  OpenImu second(settings_with(0x40), second_output);  // both claim 0x80 at once
  bus.attach(first_output, first);
  bus.attach(second_output, second);
  for (SimTime now = kStart; now < kStart + 200ms; now += 100us) {
    first.advance(now);
    second.advance(now);
    bus.advance(now);
  }
  EXPECT_EQ(first.address(), 0x80);
  EXPECT_EQ(second.address(), 0x81);
  EXPECT_TRUE(first.address_held() && second.address_held());
}

TEST(OpenImuRequest, KnownGroupsAreAnsweredAfterTheProcessingDelay) {
  Rig rig;
  rig.run(2s);
  const auto ask = [&rig](std::uint32_t pgn) {
    const std::size_t before = rig.output.frames.size();
    rig.receive(j1939::make_request(kTester, rig.imu.address(), pgn));
    EXPECT_EQ(rig.output.frames.size(), before + 1) << pgn;
    EXPECT_EQ(rig.output.frames.back().first, rig.now + 1ms);
    return rig.output.frames.back().second;
  };
  EXPECT_EQ(ask(j1939::kAddressClaimedPgn).id, 0x18EEFF80U);
  EXPECT_THAT(ask(openimu::kSoftwareVersionPgn).payload(),
              ElementsAre(1, 1, 0, 0, 0, 0xFF, 0xFF, 0xFF));
  EXPECT_THAT(ask(openimu::kEcuIdentificationPgn).payload(),
              ElementsAre(0x40, 0x23, 0xE1, 0x66, 0x00, 0x83, 0x00, 0x80));
  EXPECT_THAT(ask(openimu::kStatusPgn).payload(), ElementsAre(0, 0));
  EXPECT_TRUE(openimu::decode_slope(ask(openimu::kSlopePgn)).ok());
  EXPECT_TRUE(openimu::decode_angular_rate(ask(openimu::kAngularRatePgn)).ok());
  EXPECT_TRUE(openimu::decode_acceleration(ask(openimu::kAccelerationPgn)).ok());
  EXPECT_THAT(ask(openimu::kPacketRatePgn).payload(), ElementsAre(0x80, 1));
  EXPECT_THAT(ask(openimu::kPacketMaskPgn).payload(), ElementsAre(0x80, 7, 0));
  EXPECT_THAT(ask(openimu::kFilterPgn).payload(), ElementsAre(0x80, 25, 25));
  EXPECT_THAT(ask(openimu::kOrientationPgn).payload(), ElementsAre(0x80, 0, 0));
  EXPECT_THAT(ask(openimu::kBehaviourPgn).payload(), ElementsAre(0x80, 0x48, 0xC2));
}

TEST(OpenImuRequest, UnknownGroupIsRefusedOnlyWhenAddressedAndOnlyByThe335Ri) {
  Rig rig;
  rig.run(50ms);
  std::size_t before = rig.output.frames.size();
  rig.receive(j1939::make_request(kTester, j1939::kGlobalAddress, 65253));
  EXPECT_EQ(rig.output.frames.size(), before);
  rig.receive(j1939::make_request(kTester, 0x80, 65253));
  ASSERT_EQ(rig.output.frames.size(), before + 1);
  EXPECT_THAT(rig.output.frames.back().second.payload(),
              ElementsAre(1, 0, 0xFF, 0xFF, kTester, 0xE5, 0xFE, 0x00));
  rig.receive(j1939::make_request(kTester, 0x90, openimu::kSlopePgn));  // not ours
  EXPECT_EQ(rig.output.frames.size(), before + 1);

  Rig old(settings_with(0x12340, OpenImuVariant::openimu300ri));
  old.run(50ms);
  before = old.output.frames.size();
  old.receive(j1939::make_request(kTester, 0x80, 65253));
  EXPECT_EQ(old.output.frames.size(), before);
  EXPECT_EQ(old.imu.received().ignored, 1U);
}

class OpenImuSetting : public testing::Test {
 protected:
  void SetUp() override { rig_.run(50ms); }
  void set(openimu::SettingKind kind, std::uint8_t first, std::uint8_t second, std::uint16_t word,
           std::uint8_t destination = 0x80) {
    rig_.receive(openimu::make_setting({kind, destination, first, second, word}, kTester));
  }
  std::size_t frames_in(Duration span, std::uint32_t pgn) {
    const std::size_t before = rig_.output.of(pgn).size();
    rig_.run(span);
    return rig_.output.of(pgn).size() - before;
  }
  Rig rig_;
};

TEST_F(OpenImuSetting, EveryLegalRateComesOut) {
  const std::pair<std::uint8_t, std::size_t> table[] = {
      {1, 200}, {2, 100}, {4, 50}, {5, 40}, {10, 20}, {20, 10}, {25, 8}, {50, 4}, {0, 0}};
  for (const auto& [divider, expected] : table) {
    set(openimu::SettingKind::packet_rate, divider, 0, 0);
    EXPECT_EQ(frames_in(2s, openimu::kSlopePgn), expected) << int{divider};
  }
}

TEST_F(OpenImuSetting, MaskChoosesTheMessages) {
  set(openimu::SettingKind::packet_mask, 0, 0, openimu::PacketBit::kAngularRate | 0x08);
  EXPECT_EQ(frames_in(1s, openimu::kSlopePgn), 0U);
  EXPECT_EQ(frames_in(1s, openimu::kAngularRatePgn), 100U);
  EXPECT_EQ(rig_.imu.configuration().packet_mask, openimu::PacketBit::kAngularRate);
}

TEST_F(OpenImuSetting, IllegalValuesChangeNothing) {
  const OpenImuConfiguration before = rig_.imu.configuration();
  set(openimu::SettingKind::packet_rate, 3, 0, 0);
  set(openimu::SettingKind::filters, 25, 24, 0);
  set(openimu::SettingKind::orientation, 0, 0, 0x0001);
  set(openimu::SettingKind::packet_rate, 2, 0, 0, 0x90);  // another device
  EXPECT_EQ(rig_.imu.configuration(), before);
  EXPECT_EQ(rig_.imu.received().ignored, 4U);
}

TEST_F(OpenImuSetting, SaveAnswersTheRequesterAndKeepsTheConfiguration) {
  set(openimu::SettingKind::filters, 5, 10, 0);
  EXPECT_EQ(rig_.imu.saved_configuration().rate_cut_off_hz, 25);
  set(openimu::SettingKind::save_configuration, 0, 0, 0);
  EXPECT_EQ(rig_.output.frames.back().second.id, 0x18FF5180U);
  EXPECT_THAT(rig_.output.frames.back().second.payload(), ElementsAre(1, kTester, 1));
  EXPECT_EQ(rig_.imu.saved_configuration().rate_cut_off_hz, 5);
  EXPECT_EQ(rig_.imu.saved_configuration().acceleration_cut_off_hz, 10);
}

TEST_F(OpenImuSetting, ResetStartsTheAlgorithmAgain) {
  rig_.run(2s);
  set(openimu::SettingKind::reset_algorithm, 0, 0, 0);
  EXPECT_THAT(rig_.output.frames.back().second.payload(), ElementsAre(1, kTester, 1));
  rig_.receive(j1939::make_request(kTester, 0x80, openimu::kStatusPgn));
  EXPECT_THAT(rig_.output.frames.back().second.payload(), ElementsAre(0x00, 0x03));
}

TEST_F(OpenImuSetting, OrientationTurnsTheHousing) {
  set(openimu::SettingKind::orientation, 0, 0, 0x0009);  // -x, -y, +z
  ImuSample sample = level();
  sample.specific_force_mps2.x = 2.0;
  rig_.run(1s, sample);
  const auto force = openimu::decode_acceleration(rig_.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->longitudinal_mps2.value, -2.0, 0.006);
  EXPECT_NEAR(force->vertical_mps2.value, kGravity, 0.006);
}

TEST_F(OpenImuSetting, LegacyRequestOrderWhenTheBehaviourBitIsCleared) {
  set(openimu::SettingKind::behaviour, 0, 0,
      openimu::Behaviour::kDefault & ~openimu::Behaviour::kSwapRequestPgn);
  Frame request = j1939::make_request(kTester, 0x80, 0);
  request.data = {0x00, 0xF0, 0x29, 0, 0, 0, 0, 0};
  rig_.receive(request);
  EXPECT_TRUE(openimu::decode_slope(rig_.output.frames.back().second).ok());
}

TEST(OpenImuHostile, EveryShapeOfForeignFrameIsCountedAndHarmless) {
  Rig rig;
  rig.run(50ms);
  const OpenImuConfiguration before = rig.imu.configuration();
  const std::size_t sent = rig.output.frames.size();
  std::uint64_t fed = 0;
  for (const std::uint32_t pgn : {j1939::kAddressClaimedPgn, j1939::kRequestPgn, 0xFF50U, 0xFF51U,
                                  0xFF55U, 0xFF56U, 0xFF57U, 0xFF58U, 0xFF59U, 61481U, 0xFF5EU}) {
    for (unsigned length = 0; length <= 255; ++length) {
      for (const bool extended : {false, true}) {
        for (const bool remote : {false, true}) {
          Frame frame;
          frame.id = j1939::pack(j1939::Identifier{6, pgn, 0x80, kTester});
          frame.extended = extended;
          frame.remote = remote;
          frame.length = static_cast<std::uint8_t>(length);
          frame.data.fill(0xA5);
          rig.receive(frame);
          ++fed;
        }
      }
    }
  }
  const ReceiveCounters counters = rig.imu.received();
  EXPECT_EQ(counters.accepted + counters.ignored + counters.malformed, fed);
  EXPECT_EQ(rig.imu.configuration(), before);
  EXPECT_LE(rig.output.frames.size(), sent + 1);  // one refusal: a request of three bytes
}

TEST(OpenImuSettings, RefusedWithTheValueFound) {
  const auto refused = [](auto change) {
    OpenImuSettings settings;
    change(settings);
    Recorder output;
    EXPECT_THROW(OpenImu(settings, output), std::invalid_argument);
  };
  EXPECT_NO_THROW(validate(OpenImuSettings{}));
  refused([](auto& s) { s.source_address = 127; });
  refused([](auto& s) { s.source_address = 248; });
  refused([](auto& s) { s.serial = 0; });
  refused([](auto& s) { s.serial = 0x200000; });
  refused([](auto& s) { s.configuration.rate_divider = 3; });
  refused([](auto& s) { s.configuration.packet_mask = 8; });
  refused([](auto& s) { s.configuration.rate_cut_off_hz = 24; });
  refused([](auto& s) { s.configuration.orientation = 1; });
  refused([](auto& s) { s.configuration.behaviour = 0; });
  refused([](auto& s) { s.rate_range_radps = 0.0; });
  refused([](auto& s) { s.power_on = -1ns; });
  refused([](auto& s) { s.processing_delay = 5ms; });
}

TEST(OpenImuBusLoad, DefaultMessagesAtRestTake17Percent) {
  Recorder outside;
  CanBusModel bus(CanBusSettings{});
  FrameOutput& output = bus.add_node(outside);
  OpenImu imu(settings_with(0x12345, OpenImuVariant::openimu300ri), output);
  bus.attach(output, imu);
  SimTime now = kStart;
  for (; now < kStart + 2500ms; now += OpenImu::kTick) {
    bus.advance(now);
    ImuSample rest = level(now);
    rest.specific_force_mps2.z = 9.81;
    imu.update(rest);
  }
  bus.advance(now);
  // 144 + 143 + 141 bits at 100 Hz and one claim a second.
  EXPECT_NEAR(bus.load(now), 0.1712 + 0.0006, 0.0002);
}

}  // namespace
}  // namespace rigwire::emulators
