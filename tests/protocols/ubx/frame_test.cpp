#include "protocols/ubx/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "protocols/ubx/configuration.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/version.h"

namespace rigwire::protocols::ubx {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(std::string_view text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(
        static_cast<std::uint8_t>(std::stoi(std::string(text.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

// Frames recorded from a NEO-7P.
constexpr std::string_view kPollMonVer = "b5620a0400000e34";
constexpr std::string_view kAckOfCfgAnt = "b562050102000613214a";
constexpr std::string_view kNak = "b5620500020006616e93";
constexpr std::string_view kCfgRate = "b56206080600e803010001000139";
constexpr std::string_view kCfgPrtUart = "b5620600140001000000c008000080250000070003000000000092b5";
constexpr std::string_view kCfgPrtUsb = "b56206001400030000000000000000000000070003000000000027ce";
constexpr std::string_view kCfgMsg = "b562060108000b300000000000004a4b";
constexpr std::string_view kCfgSbas = "b5620616080001030300d1a20600a4ef";
constexpr std::string_view kCfgGnss =
    "b562063e2400001616040004ff0001000000010103000100000005000300010000000608ff0000000000b813";
constexpr std::string_view kCfgNav5 =
    "b56206242400ffff000300000000102700000500fa00fa0064002c01003c00000000000000000000000"
    "04c1c";
constexpr std::string_view kRxmRawEmpty = "b56202100800d8590000000000004b47";

TEST(UbxFrame, RecordedFramesDecodeAndEncodeToTheSameBytes) {
  for (const auto hex : {kPollMonVer, kAckOfCfgAnt, kNak, kCfgRate, kCfgPrtUart, kCfgPrtUsb,
                         kCfgMsg, kCfgSbas, kCfgGnss, kCfgNav5, kRxmRawEmpty}) {
    const Bytes bytes = from_hex(hex);
    const auto frame = decode_frame(bytes);
    ASSERT_TRUE(frame.ok()) << hex;
    EXPECT_EQ(frame.consumed(), bytes.size());
    Bytes again(bytes.size());
    EXPECT_EQ(encode_frame(frame->id, frame->payload, again), bytes.size());
    EXPECT_EQ(again, bytes);
  }
}

template <class Message>
void expect_round_trip(std::string_view hex) {
  const Bytes bytes = from_hex(hex);
  const auto frame = decode_frame(bytes);
  ASSERT_TRUE(frame.ok());
  const auto message = decode<Message>(*frame);
  ASSERT_TRUE(message.ok());
  const auto again = encode(*message);
  EXPECT_EQ(Bytes(again.begin(), again.end()), bytes);
}

TEST(UbxMessages, RecordedMessagesSurviveTheirStructs) {
  expect_round_trip<AckAck>(kAckOfCfgAnt);
  expect_round_trip<AckNak>(kNak);
  expect_round_trip<CfgRate>(kCfgRate);
  expect_round_trip<CfgPrt>(kCfgPrtUart);
  expect_round_trip<CfgPrt>(kCfgPrtUsb);
  expect_round_trip<CfgMsg>(kCfgMsg);
  expect_round_trip<CfgSbas>(kCfgSbas);
  expect_round_trip<CfgNav5>(kCfgNav5);
}

TEST(UbxMessages, FieldsStandWhereTheRecordingHasThem) {
  const Bytes port = from_hex(kCfgPrtUart);
  const auto prt = decode<CfgPrt>(*decode_frame(port));
  ASSERT_TRUE(prt.ok());
  EXPECT_EQ(prt->port, 1);
  EXPECT_EQ(prt->mode, 0x08C0U);
  EXPECT_EQ(prt->baud, 9600U);
  EXPECT_EQ(prt->input_protocols, 7);
  EXPECT_EQ(prt->output_protocols, 3);

  const Bytes navigation = from_hex(kCfgNav5);
  const auto nav5 = decode<CfgNav5>(*decode_frame(navigation));
  ASSERT_TRUE(nav5.ok());
  EXPECT_EQ(nav5->fix_mode, 3);
  EXPECT_EQ(nav5->minimum_elevation_deg, 5);
  EXPECT_EQ(nav5->position_dilution_mask_e1, 250);
  EXPECT_EQ(nav5->position_accuracy_mask_m, 100);
  EXPECT_EQ(nav5->time_accuracy_mask_m, 300);
  EXPECT_EQ(nav5->differential_timeout_s, 60);
}

TEST(UbxMessages, LengthsAreThoseOfProtocol14) {
  EXPECT_EQ(NavPosecef::kLength, 20U);
  EXPECT_EQ(NavPosllh::kLength, 28U);
  EXPECT_EQ(NavStatus::kLength, 16U);
  EXPECT_EQ(NavDop::kLength, 18U);
  EXPECT_EQ(NavSol::kLength, 52U);
  EXPECT_EQ(NavPvt::kLength, 84U);
  EXPECT_EQ(NavVelecef::kLength, 20U);
  EXPECT_EQ(NavVelned::kLength, 36U);
  EXPECT_EQ(NavTimegps::kLength, 16U);
  EXPECT_EQ(NavTimeutc::kLength, 20U);
  EXPECT_EQ(NavClock::kLength, 20U);
  EXPECT_EQ(NavSvinfoHead::kLength, 8U);
  EXPECT_EQ(NavSvinfoChannel::kLength, 12U);
  EXPECT_EQ(MonVerHead::kLength, 40U);
  EXPECT_EQ(MonHw::kLength, 60U);
  EXPECT_EQ(CfgPrt::kLength, 20U);
  EXPECT_EQ(CfgMsg::kLength, 8U);
  EXPECT_EQ(CfgInf::kLength, 10U);
  EXPECT_EQ(CfgNmea::kLength, 12U);
  EXPECT_EQ(CfgNavx5::kLength, 40U);
  EXPECT_EQ(CfgNav5::kLength, 36U);
  EXPECT_EQ(CfgTp5::kLength, 32U);
}

TEST(UbxMessages, NegativeNumbersSurvive) {
  NavPvt pvt;
  pvt.nanosecond = -700'000;
  pvt.latitude_e7deg = -338'765'432;
  pvt.velocity_ned_mmps = {-1, 2, -2'000'000'000};
  const auto frame = encode(pvt);
  const auto again = decode<NavPvt>(*decode_frame(frame));
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(*again, pvt);
}

TEST(UbxMessages, AnotherMessageOrLengthIsMalformed) {
  const Bytes bytes = from_hex(kCfgRate);
  const auto frame = decode_frame(bytes);
  EXPECT_TRUE(decode<CfgPrt>(*frame).malformed());
  FrameView cut = *frame;
  cut.payload = cut.payload.first(5);
  EXPECT_TRUE(decode<CfgRate>(cut).malformed());
}

TEST(UbxFrame, EveryCutIsIncomplete) {
  const Bytes bytes = from_hex(kCfgGnss);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto frame = decode_frame(std::span(bytes).first(size));
    ASSERT_TRUE(frame.incomplete()) << size;
    EXPECT_GT(frame.shortage().needed, size);
    EXPECT_EQ(frame.shortage().had, size);
  }
}

TEST(UbxFrame, EveryFlippedBitIsNoticed) {
  const Bytes good = from_hex(kCfgRate);
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_FALSE(decode_frame(bad).ok()) << bit;
  }
}

TEST(UbxFrame, OversizedPayloadIsMalformedAtOnce) {
  const Bytes head = from_hex("b5620600ffff");
  EXPECT_TRUE(decode_frame(head, 512).malformed());
  EXPECT_TRUE(decode_frame(head).incomplete());
}

TEST(UbxFrame, ResynchronisesOnTheNextSync) {
  const Bytes bytes = from_hex("b500b562b5");
  EXPECT_EQ(find_sync(bytes, 0), 2U);
  EXPECT_EQ(find_sync(bytes, 3), 4U);  // a lone first character at the end may become a frame
  EXPECT_EQ(find_sync(bytes, 5), 5U);
}

TEST(UbxFrame, TooSmallRoomWritesNothing) {
  Bytes room(9, 0x55);
  const Bytes payload{1, 2};
  EXPECT_EQ(encode_frame({6, 1}, payload, room), 0U);
  EXPECT_EQ(room, Bytes(9, 0x55));
}

TEST(UbxVersion, TextsSurviveAndOddLengthsAreRefused) {
  const Version version{"1.00 (71863)", "00070000", {"PROTVER 14.00", "GPS;SBAS;GLO;QZSS"}};
  const Bytes payload = version_payload(version);
  EXPECT_EQ(payload.size(), 100U);
  const auto again = decode_version({MonVerHead::kId, payload});
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(*again, version);
  EXPECT_TRUE(decode_version({MonVerHead::kId, std::span(payload).first(99)}).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::ubx
