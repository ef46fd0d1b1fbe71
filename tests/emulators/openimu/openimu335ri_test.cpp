#include "emulators/openimu/openimu335ri.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "emulators/can/can_bus.h"
#include "rig.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::ElementsAre;
namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using protocols::openimu::FigureOfMerit;

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr std::uint8_t kOpenimu335riTester = 0x21;

TEST(OpenImu, ClaimsAfterItsSerialDelayAndSendsNothingBefore) {
  OpenImuRig rig(settings_with(0x12345));  // 5 * 5 ms
  rig.run(100ms);
  ASSERT_FALSE(rig.output.frames.empty());
  const auto& [due, claim] = rig.output.frames.front();
  EXPECT_EQ(due, kStart + 25ms + 1ms);
  EXPECT_EQ(claim.id, 0x18EEFF80U);
  EXPECT_THAT(claim.payload(), ElementsAre(0x45, 0x23, 0xE1, 0x66, 0x00, 0x83, 0x00, 0x80));
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).size(), 1U);
}

TEST(OpenImu, ClaimsWithoutSamplesToo) {
  test::FrameRecorder output;
  OpenImu imu(settings_with(3), output);
  imu.advance(kStart);
  EXPECT_EQ(imu.next_event(), kStart + 15ms);
  imu.advance(kStart + 14ms);
  EXPECT_TRUE(output.frames.empty());
  imu.advance(kStart + 1s);
  EXPECT_EQ(output.frames.size(), 1U);
  EXPECT_EQ(imu.next_event(), kNever);
}

TEST(OpenImu, AllThreeMessagesAt100HzByDefault) {
  OpenImuRig rig;
  rig.run(1010ms);  // the claim, then a second
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).size(), 100U);
  EXPECT_EQ(rig.output.of(openimu::kAngularRatePgn).size(), 100U);
  EXPECT_EQ(rig.output.of(openimu::kAccelerationPgn).size(), 100U);
}

TEST(OpenImu, RestBytesOfThe300RiAreTheKnownFrames) {
  OpenImuRig rig(settings_with(0x12345, OpenImuVariant::openimu300ri));
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
  OpenImuRig rig;
  rig.run(500ms);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).back().data[6], 0b0100'0100);  // degraded
  rig.run(1s);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).back().data[6], 0x00);
  EXPECT_EQ(rig.output.of(openimu::kAngularRatePgn).back().data[6], 0x00);
  EXPECT_EQ(rig.output.of(openimu::kAccelerationPgn).back().data[6], 0x80);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).back().data[7], 2);  // 1 ms
}

TEST(OpenImu, Claim300RiRepeatsEverySecond) {
  OpenImuRig rig(settings_with(0x12345, OpenImuVariant::openimu300ri));
  rig.run(3s);
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).size(), 3U);
}

TEST(OpenImuSigns, NoseUpRightDownClockwise) {
  OpenImuRig rig;
  ImuSample sample = level();
  const double pitch = 20.0 * kRadians;
  const double roll = 10.0 * kRadians;
  sample.specific_force_mps2 = {kGravity * std::sin(pitch),
                                kGravity * std::cos(pitch) * std::sin(roll),
                                kGravity * std::cos(pitch) * std::cos(roll)};
  rig.run(2s, sample);
  const auto slope = openimu::decode<openimu::Slope>(rig.output.of(openimu::kSlopePgn).back());
  EXPECT_NEAR(slope->pitch_deg, 20.0, openimu::kSlopeAngle.count);
  EXPECT_NEAR(slope->roll_deg, 10.0, openimu::kSlopeAngle.count);

  sample.angular_rate_radps = {3.0 * kRadians, -5.0 * kRadians, -7.0 * kRadians};
  rig.run(1s, sample);
  const auto rate =
      openimu::decode<openimu::AngularRate>(rig.output.of(openimu::kAngularRatePgn).back());
  EXPECT_NEAR(rate->pitch_dps, 5.0, openimu::kRate.count);
  EXPECT_NEAR(rate->roll_dps, 3.0, openimu::kRate.count);
  EXPECT_NEAR(rate->yaw_dps, 7.0, openimu::kRate.count);
}

TEST(OpenImuSigns, AccelerationIsLeftForwardUp) {
  OpenImuRig rig;
  ImuSample sample = level();
  sample.specific_force_mps2 = {1.5, 2.5, 9.0};
  rig.run(1s, sample);
  const auto force =
      openimu::decode<openimu::Acceleration>(rig.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->longitudinal_mps2, 1.5, 0.005 + 1e-9);
  EXPECT_NEAR(force->lateral_mps2, 2.5, 0.005 + 1e-9);
  EXPECT_NEAR(force->vertical_mps2, 9.0, 0.005 + 1e-9);
}

TEST(OpenImuSaturation, RateBeyondTheMessageIsClampedAndAnError) {
  OpenImuRig rig;
  rig.run(2s);
  ImuSample fast = level();
  fast.angular_rate_radps.z = -300.0 * kRadians;
  rig.run(1s, fast);
  const auto rate =
      openimu::decode<openimu::AngularRate>(rig.output.of(openimu::kAngularRatePgn).back());
  EXPECT_EQ(rate->yaw_dps, 250.0);
  EXPECT_EQ(rate->yaw_merit, FigureOfMerit::kError);
  EXPECT_EQ(rate->pitch_merit, FigureOfMerit::kFunctional);
}

TEST(OpenImuSaturation, ForceBeyondTheElementIsClampedAndDegraded) {
  OpenImuRig rig;
  rig.run(2s);
  ImuSample hit = level();
  hit.specific_force_mps2.x = 500.0;
  rig.run(1s, hit);
  const auto force =
      openimu::decode<openimu::Acceleration>(rig.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->longitudinal_mps2, 8.0 * kGravity, 0.01);
  EXPECT_EQ(force->longitudinal_merit, FigureOfMerit::kDegraded);
  EXPECT_EQ(force->lateral_merit, FigureOfMerit::kFunctional);
}

TEST(OpenImuFault, SampleThatIsNoNumberIsSentAsErrorAndForgotten) {
  OpenImuRig rig;
  rig.run(2s);
  ImuSample broken = level();
  broken.specific_force_mps2.x = std::numeric_limits<double>::quiet_NaN();
  rig.run(20ms, broken);
  const Frame frame = rig.output.of(openimu::kAccelerationPgn).back();
  EXPECT_EQ(frame.data[1], 0xFE);
  EXPECT_EQ(frame.data[6], 0b1010'1010);
  rig.run(1s);
  const auto force =
      openimu::decode<openimu::Acceleration>(rig.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->vertical_mps2, kGravity, 0.006);
}

TEST(OpenImuFault, TroubleMessageAtOnceThenEveryTenSeconds) {
  OpenImuRig rig;
  rig.run(1s);
  ImuSample broken = level();
  broken.angular_rate_radps.z = std::numeric_limits<double>::infinity();
  rig.run(25s, broken);
  auto troubles = rig.output.of(openimu::kActiveTroublePgn);
  ASSERT_EQ(troubles.size(), 3U);
  EXPECT_EQ(troubles[0].id, 0x18FECA80U);
  EXPECT_THAT(troubles[0].payload(), ElementsAre(0x00, 0xFF, 0xFF, 0xFF, 0xFF, 1, 0xFF, 0xFF));
  rig.run(20s);
  EXPECT_EQ(rig.output.of(openimu::kActiveTroublePgn).size(), 3U);
  rig.run(20ms, broken);
  EXPECT_EQ(rig.output.of(openimu::kActiveTroublePgn).back().data[5], 2);
}

TEST(OpenImuMagneticField, The300RiSendsItInGaussAndAerospaceAxes) {
  OpenImuSettings settings = settings_with(0x12341, OpenImuVariant::openimu300ri);
  settings.configuration.packet_mask = openimu::PacketBit::kOf300;
  OpenImuRig rig(settings);
  rig.run(20ms);
  EXPECT_EQ(rig.output.of(openimu::kMagneticFieldPgn).back().data[1], 0xFF);  // not available
  ImuSample sample = level();
  sample.magnetic_field_t = {20e-6, 5e-6, -44e-6};
  rig.run(20ms, sample);
  const auto field =
      openimu::decode<openimu::MagneticField>(rig.output.of(openimu::kMagneticFieldPgn).back());
  EXPECT_NEAR(field->x_gauss, 0.20, openimu::kMagnetic.count);
  EXPECT_NEAR(field->y_gauss, -0.05, openimu::kMagnetic.count);
  EXPECT_NEAR(field->z_gauss, 0.44, openimu::kMagnetic.count);
}

TEST(OpenImuMemory, SavedSettingsAndAddressOutliveThePowerCycle) {
  OpenImuSettings settings = settings_with(0x12341);
  settings.supply.faults = rigwire::test::cuts({2s, 4s});
  OpenImuRig rig(settings);
  rig.run(100ms);
  rig.receive(openimu::make_setting({openimu::SettingKind::packet_rate, 0x80, 4, 0, 0},
                                    kOpenimu335riTester));
  rig.receive(openimu::make_setting({openimu::SettingKind::save_configuration, 0x80, 0, 0, 0},
                                    kOpenimu335riTester));
  rig.receive(
      openimu::make_setting({openimu::SettingKind::filters, 0x80, 5, 5, 0}, kOpenimu335riTester));
  rig.receive(j1939::make_address_claim(0x80, 1));  // lost, not saved by anybody
  rig.run(2s);                                      // off from 2 s to 2.5 s
  const std::size_t before = rig.output.frames.size();
  EXPECT_FALSE(rig.imu.address_held());
  rig.run(300ms);
  EXPECT_EQ(rig.output.frames.size(), before);
  rig.run(600ms);
  EXPECT_EQ(rig.imu.address(), 0x81);
  EXPECT_EQ(rig.imu.configuration().rate_divider, 4);
  EXPECT_EQ(rig.imu.configuration().rate_cut_off_hz, 25);
  // A second device with the same memory is the same device.
  test::FrameRecorder output;
  OpenImu again(settings, rig.memory, output);
  again.advance(kStart + 1s);
  EXPECT_EQ(again.configuration().rate_divider, 4);
}

TEST(OpenImuMemory, DamageIsReportedAndDeliverySettingsReturn) {
  OpenImuRig rig;
  rig.run(100ms);
  rig.receive(openimu::make_setting({openimu::SettingKind::packet_rate, 0x80, 4, 0, 0},
                                    kOpenimu335riTester));
  openimu::Setting save{openimu::SettingKind::save_configuration, 0x80, 2, 0, 0};  // and restart
  for (std::size_t i = 0;; ++i) {
    rig.receive(openimu::make_setting(save, kOpenimu335riTester));
    std::vector<std::uint8_t> block(rig.memory.content().begin(), rig.memory.content().end());
    if (i == block.size()) {
      break;
    }
    block[i] ^= 0x04;
    ASSERT_TRUE(rig.memory.store(block));
    rig.run(150ms);
    EXPECT_EQ(rig.imu.configuration().rate_divider, 1) << i;
    rig.receive(j1939::make_request(kOpenimu335riTester, 0x80, openimu::kStatusPgn));
    EXPECT_EQ(rig.output.frames.back().second.data[0] & 0x83, 0x83) << i;
    rig.receive(openimu::make_setting({openimu::SettingKind::packet_rate, 0x80, 4, 0, 0},
                                      kOpenimu335riTester));
  }
}

TEST(OpenImuHostile, EveryShapeOfForeignFrameIsCountedAndHarmless) {
  OpenImuRig rig;
  rig.run(50ms);
  const OpenImuConfiguration before = rig.imu.configuration();
  const std::size_t sent = rig.output.frames.size();
  std::uint64_t fed = 0;
  for (const std::uint32_t pgn :
       {j1939::kAddressClaimedPgn, j1939::kRequestPgn, 0xFF50U, 0xFF51U, 0xFF55U, 0xFF56U, 0xFF57U,
        0xFF58U, 0xFF59U, 61481U, 0xFF5AU, 0xFF5EU, 0xFFF0U, 0xFFF1U, 0xFFF2U}) {
    for (unsigned length = 0; length <= 255; ++length) {
      for (const bool extended : {false, true}) {
        for (const bool remote : {false, true}) {
          Frame frame;
          frame.id = j1939::pack(j1939::Identifier{6, pgn, 0x80, kOpenimu335riTester});
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
  EXPECT_EQ(rig.output.frames.size(), sent);
}

TEST(OpenImuSettings, RefusedWithTheValueFound) {
  const auto refused = [](auto change) {
    OpenImuSettings settings;
    change(settings);
    test::FrameRecorder output;
    EXPECT_THROW(OpenImu(settings, output), std::invalid_argument);
  };
  EXPECT_NO_THROW(validate(OpenImuSettings{}));
  refused([](auto& s) { s.source_address = 127; });
  refused([](auto& s) { s.source_address = 248; });
  refused([](auto& s) { s.serial = 0; });
  refused([](auto& s) { s.serial = 0x200000; });
  refused([](auto& s) { s.configuration.rate_divider = 3; });
  refused([](auto& s) { s.configuration.packet_mask = 0x10; });
  refused([](auto& s) { s.configuration.rate_cut_off_hz = 24; });
  refused([](auto& s) { s.configuration.orientation = 1; });
  refused([](auto& s) { s.configuration.behaviour = 0; });
  refused([](auto& s) { s.rate_range_radps = 0.0; });
  refused([](auto& s) { s.supply.power_on = -1ns; });
  refused([](auto& s) { s.processing_delay = 5ms; });
}

TEST(OpenImuBusLoad, DefaultMessagesAtRestTake17Percent) {
  test::FrameRecorder outside;
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

TEST(OpenImuMessages, AreThoseOfTheVariantWithTheirPeriods) {
  OpenImuRig newer;
  EXPECT_EQ(newer.imu.messages("boom").size(), 5U);
  EXPECT_EQ(newer.imu.messages("boom")[0].period_ms, 10U);
  EXPECT_EQ(newer.imu.messages("boom")[0].sender, "boom");
  OpenImuRig older(settings_with(0x12341, OpenImuVariant::openimu300ri));
  ASSERT_EQ(older.imu.messages("boom").size(), 4U);
  EXPECT_EQ(older.imu.messages("boom")[3].id, 0x18FF6A80U);
  EXPECT_EQ(older.imu.messages("boom")[3].period_ms, 0U);  // off, or on request
}

}  // namespace
}  // namespace rigwire::emulators
