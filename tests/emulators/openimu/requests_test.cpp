#include "emulators/openimu/openimu335ri.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::ElementsAre;
namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;

constexpr std::uint8_t kTester = 0x21;

TEST(OpenImuRequest, KnownGroupsAreAnsweredAfterTheProcessingDelay) {
  OpenImuRig rig;
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
  OpenImuRig rig;
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

  OpenImuRig old(settings_with(0x12340, OpenImuVariant::openimu300ri));
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
  OpenImuRig rig_;
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

}  // namespace
}  // namespace rigwire::emulators
