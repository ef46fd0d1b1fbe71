#include "emulators/openimu/openimu335ri.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
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

constexpr std::uint8_t kRequestsTester = 0x21;

TEST(OpenImuRequest, KnownGroupsAreAnsweredAfterTheProcessingDelay) {
  OpenImuRig rig;
  rig.run(2s);
  const auto ask = [&rig](std::uint32_t pgn) {
    const std::size_t before = rig.output.frames.size();
    rig.receive(j1939::make_request(kRequestsTester, rig.imu.address(), pgn));
    EXPECT_EQ(rig.output.frames.size(), before + 1) << pgn;
    EXPECT_EQ(rig.output.frames.back().first, rig.now + 1ms);
    return rig.output.frames.back().second;
  };
  EXPECT_EQ(ask(j1939::kAddressClaimedPgn).id, 0x18EEFF80U);
  EXPECT_THAT(ask(openimu::kSoftwareVersionPgn).payload(),
              ElementsAre(1, 1, 0, 0, 0, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kEcuIdentificationPgn).payload(),
              ElementsAre(0x41, 0x23, 0xE1, 0x66, 0x00, 0x83, 0x00, 0x80));
  EXPECT_THAT(ask(openimu::kStatusPgn).payload(), ElementsAre(0, 0, 0, 0, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kHardwareStatusPgn).payload(),
              ElementsAre(0, 0, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kSoftwareStatusPgn).payload(),
              ElementsAre(0, 0, 0, 0, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_TRUE(openimu::decode<openimu::Slope1>(ask(openimu::kSlope1Pgn)).ok());
  EXPECT_TRUE(openimu::decode<openimu::FineRate>(ask(openimu::kFineRatePgn)).ok());
  EXPECT_TRUE(openimu::decode<openimu::Slope>(ask(openimu::kSlopePgn)).ok());
  EXPECT_TRUE(openimu::decode<openimu::AngularRate>(ask(openimu::kAngularRatePgn)).ok());
  EXPECT_TRUE(openimu::decode<openimu::Acceleration>(ask(openimu::kAccelerationPgn)).ok());
  EXPECT_THAT(ask(openimu::kPacketRatePgn).payload(),
              ElementsAre(kRequestsTester, 1, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kPacketMaskPgn).payload(),
              ElementsAre(kRequestsTester, 7, 0, 0x3B, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kFilterPgn).payload(),
              ElementsAre(kRequestsTester, 25, 25, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kOrientationPgn).payload(),
              ElementsAre(kRequestsTester, 0, 0, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_THAT(ask(openimu::kBehaviourPgn).payload(),
              ElementsAre(kRequestsTester, 0x48, 0xC2, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
}

TEST(OpenImuRequest, UnknownGroupsAndRequestsForOthersAreNotAnswered) {
  for (const OpenImuVariant variant :
       {OpenImuVariant::openimu335ri, OpenImuVariant::openimu300ri}) {
    OpenImuRig rig(settings_with(0x12341, variant));
    rig.run(50ms);
    const std::size_t before = rig.output.frames.size();
    rig.receive(j1939::make_request(kRequestsTester, j1939::kGlobalAddress, 65253));
    rig.receive(j1939::make_request(kRequestsTester, 0x80, 65253));
    rig.receive(j1939::make_request(kRequestsTester, 0x90, openimu::kSlopePgn));
    EXPECT_EQ(rig.output.frames.size(), before);
    EXPECT_EQ(rig.imu.received().ignored, 3U);
  }
}

TEST(OpenImuRequest, The300RiAnswersWithItsOwnAddressAndItsOwnLengths) {
  OpenImuRig rig(settings_with(0x12341, OpenImuVariant::openimu300ri));
  rig.run(2s);
  const auto ask = [&rig](std::uint32_t pgn) {
    rig.receive(j1939::make_request(kRequestsTester, 0x80, pgn));
    return rig.output.frames.back().second;
  };
  EXPECT_THAT(ask(openimu::kSoftwareVersionPgn).payload(), ElementsAre(1, 1, 0, 0, 0));
  EXPECT_EQ(ask(0xFD00).id, 0x18FDC580U);  // any group of that format
  EXPECT_THAT(ask(openimu::kStatusPgn).payload(), ElementsAre(0, 0));
  rig.receive(
      openimu::make_setting({openimu::SettingKind::filters, 0x80, 5, 10, 0}, kRequestsTester));
  EXPECT_THAT(ask(openimu::kFilterPgn).payload(), ElementsAre(0x80, 10, 5));
  EXPECT_THAT(ask(openimu::kPacketMaskPgn).payload(), ElementsAre(0x80, 7, 0));
  EXPECT_EQ(ask(openimu::kMagneticRequestPgn).id, 0x18FF6A80U);
  EXPECT_EQ(ask(openimu::kMagneticFieldPgn).id, 0x18FF6A80U);
}

class OpenImuSetting : public testing::Test {
 protected:
  void SetUp() override { rig_.run(50ms); }
  void set(openimu::SettingKind kind, std::uint8_t first, std::uint8_t second, std::uint16_t word,
           std::uint8_t destination = 0x80) {
    rig_.receive(openimu::make_setting({kind, destination, first, second, word}, kRequestsTester));
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
  set(openimu::SettingKind::packet_mask, 0, 0, openimu::PacketBit::kAngularRate | 0x10);
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
  EXPECT_THAT(rig_.output.frames.back().second.payload(),
              ElementsAre(1, kRequestsTester, 1, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
  EXPECT_EQ(rig_.imu.saved_configuration().rate_cut_off_hz, 5);
  EXPECT_EQ(rig_.imu.saved_configuration().acceleration_cut_off_hz, 10);
}

TEST_F(OpenImuSetting, ResetStartsTheAlgorithmAgain) {
  rig_.run(2s);
  set(openimu::SettingKind::reset_algorithm, 0, 0, 0);
  EXPECT_THAT(rig_.output.frames.back().second.payload(),
              ElementsAre(1, kRequestsTester, 1, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA));
  rig_.receive(j1939::make_request(kRequestsTester, 0x80, openimu::kStatusPgn));
  EXPECT_THAT(rig_.output.frames.back().second.payload(),
              ElementsAre(0, 3, 0, 0, 0xAA, 0xAA, 0xAA, 0xAA));
}

TEST_F(OpenImuSetting, OrientationTurnsTheHousing) {
  set(openimu::SettingKind::orientation, 0, 0, 0x0009);  // -x, -y, +z
  ImuSample sample = level();
  sample.specific_force_mps2.x = 2.0;
  rig_.run(1s, sample);
  const auto force =
      openimu::decode<openimu::Acceleration>(rig_.output.of(openimu::kAccelerationPgn).back());
  EXPECT_NEAR(force->longitudinal_mps2, -2.0, 0.006);
  EXPECT_NEAR(force->vertical_mps2, kGravity, 0.006);
}

TEST_F(OpenImuSetting, LegacyRequestOrderWhenTheBehaviourBitIsCleared) {
  openimu::Setting setting{openimu::SettingKind::behaviour, 0x80, 0, 0, 0};
  setting.more = {0x00, 0x02};
  rig_.receive(openimu::make_setting(setting, kRequestsTester));
  Frame request = j1939::make_request(kRequestsTester, 0x80, 0);
  request.data = {0x00, 0xF0, 0x29, 0, 0, 0, 0, 0};
  rig_.receive(request);
  EXPECT_TRUE(openimu::decode<openimu::Slope>(rig_.output.frames.back().second).ok());
}

TEST_F(OpenImuSetting, OtherMessagesOfThe335Ri) {
  set(openimu::SettingKind::packet_mask, 0, 0,
      openimu::PacketBit::kSlope1 | openimu::PacketBit::kFineRate);
  EXPECT_EQ(frames_in(1s, openimu::kSlope1Pgn), 100U);
  EXPECT_EQ(rig_.output.of(openimu::kSlope1Pgn).back().id, 0x0CF01380U);
  EXPECT_EQ(rig_.output.of(openimu::kFineRatePgn).back().id, 0x0CFF6B80U);
  // At rest: 64 * 500 = 0x7D00 each, merits 0, latency 1 ms.
  EXPECT_THAT(rig_.output.of(openimu::kSlope1Pgn).back().payload(),
              ElementsAre(0x00, 0x7D, 0x00, 0x7D, 0x00, 0x7D, 0x00, 0x02));
}

TEST_F(OpenImuSetting, PrioritiesOfThe335RiMoveOnlyWhenMeant) {
  rig_.receive(openimu::make_setting(
      {openimu::SettingKind::packet_mask, 0x80, 0b00'01'00, 0b00'11'00, 7}, kRequestsTester));
  rig_.run(20ms);
  EXPECT_EQ(rig_.output.of(openimu::kAccelerationPgn).back().id, 0x04F02D80U);
  EXPECT_EQ(rig_.output.of(openimu::kSlopePgn).back().id, 0x0CF02980U);
}

TEST_F(OpenImuSetting, BehaviourOfThe335RiSetsAndClearsBits) {
  openimu::Setting setting{openimu::SettingKind::behaviour, 0x80, 0, 0, 0};
  setting.more = {0x08, 0x80};  // neither swapped nor with its algorithm
  rig_.receive(openimu::make_setting(setting, kRequestsTester));
  EXPECT_EQ(rig_.imu.configuration().behaviour, 0xC248 & ~0x8008);
  EXPECT_EQ(frames_in(100ms, openimu::kSlopePgn), 0U);
  EXPECT_EQ(frames_in(100ms, openimu::kAngularRatePgn), 10U);
}

TEST_F(OpenImuSetting, CommandsMoveToOtherGroups) {
  Frame bank;
  bank.extended = true;
  bank.id = j1939::pack(j1939::Identifier{6, openimu::kBank1Pgn, 0xFF, kRequestsTester});
  bank.length = 8;
  bank.data = {0x80, 0x65, 0x00, 0x3F, 0x6C, 0x6D, 0x00, 0x00};  // rate and orientation are legal
  rig_.receive(bank);
  EXPECT_EQ(rig_.imu.configuration().commands,
            (openimu::CommandMap{0x50, 0x51, 0x52, 0x53, 0x54, 0x65, 0x56, 0x57, 0x6C, 0x59, 0x5A,
                                 0x5E, 0x6B}));
  set(openimu::SettingKind::packet_rate, 2, 0, 0);  // the old group: nobody listens
  EXPECT_EQ(rig_.imu.configuration().rate_divider, 1);
  Frame rate = openimu::make_setting({openimu::SettingKind::packet_rate, 0x80, 2, 0, 0},
                                     kRequestsTester, rig_.imu.configuration().commands);
  EXPECT_EQ(rate.id, 0x18FF6521U);
  rig_.receive(rate);
  EXPECT_EQ(rig_.imu.configuration().rate_divider, 2);
}

TEST(OpenImuBank, The300RiTakesAllOrNothing) {
  openimu::CommandMap map = openimu::kDeliveredCommands;
  const std::array<std::uint8_t, 7> wrong{0x60, 0x61, 0x62, 0x6B, 0, 0, 0};
  EXPECT_FALSE(openimu::apply_bank(map, openimu::kBank0Pgn, wrong, true));
  EXPECT_EQ(map, openimu::kDeliveredCommands);
  const std::array<std::uint8_t, 7> good{0x60, 0, 0x62, 0x63, 0, 0, 0};
  EXPECT_TRUE(openimu::apply_bank(map, openimu::kBank0Pgn, good, true));
  EXPECT_EQ(pgn_of(map, openimu::Command::reset_algorithm), 0xFF60U);
  EXPECT_EQ(pgn_of(map, openimu::Command::save_configuration), 0xFF51U);
  EXPECT_EQ(pgn_of(map, openimu::Command::master_status), 0xFF62U);
  EXPECT_EQ(pgn_of(map, openimu::Command::magnetic_alignment), 0xFF63U);
}

TEST_F(OpenImuSetting, TroubleMessagesAreClearedAndAcknowledgedInAceinnasOrder) {
  Frame clear;
  clear.extended = true;
  clear.id = j1939::pack(j1939::Identifier{6, openimu::kClearTroublePgn, 0xFF, kRequestsTester});
  rig_.receive(clear);
  EXPECT_EQ(rig_.output.frames.back().second.id, 0x18E8FF80U);
  EXPECT_THAT(rig_.output.frames.back().second.payload(),
              ElementsAre(0, 0, 0xFF, 0xFF, kRequestsTester, 0xD3, 0xFE, 0x00));
}

TEST_F(OpenImuSetting, AidingMessagesAreCounted) {
  for (const std::uint32_t pgn :
       {openimu::kTransmissionPgn, openimu::kWheelSpeedPgn, openimu::kVehicleSpeedPgn}) {
    const std::array<std::uint8_t, 8> payload{};
    rig_.receive(j1939::make_frame({6, pgn, 0xFF, 0x00}, payload));
  }
  EXPECT_EQ(rig_.imu.aiding_messages(), 3U);
}

TEST(OpenImuAlignment, IsAnsweredIdleByThe300Ri) {
  OpenImuRig rig(settings_with(0x12341, OpenImuVariant::openimu300ri));
  rig.run(50ms);
  rig.receive(openimu::make_setting({openimu::SettingKind::magnetic_alignment, 0x80, 1, 0, 0},
                                    kRequestsTester));
  EXPECT_EQ(rig.output.frames.back().second.id, 0x18FF5E80U);
  // 8 G * 256 = 2048 twice, ratio 0, angle pi = 2048.
  EXPECT_THAT(rig.output.frames.back().second.payload(),
              ElementsAre(1, 0, 0x00, 0x08, 0x80, 0x00, 0x00, 0x20));
}

}  // namespace
}  // namespace rigwire::emulators
