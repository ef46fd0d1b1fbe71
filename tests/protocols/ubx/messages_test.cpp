#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/information.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/timing.h"

namespace rigwire::protocols::ubx {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The length that the documents give, and fields that fit it.
template <class Message, std::size_t kDocumented>
constexpr bool is() {
  return Message::kLength == kDocumented && layout_is_sound<Message>();
}

// Class 0x01.
static_assert(is<NavPvt, 84>() && is<NavPvt92, 92>() && is<NavTimels, 24>() && is<NavEoe, 4>());
static_assert(is<NavAopstatus, 16>() && is<NavSvinfoHead, 8>() && is<NavSvinfoChannel, 12>());
static_assert(is<NavSatHead, 8>() && is<NavSatBlock, 12>());
static_assert(is<NavSigHead, 8>() && is<NavSigBlock, 16>());
static_assert(is<NavOrbHead, 8>() && is<NavOrbBlock, 6>());
static_assert(is<NavDgpsHead, 16>() && is<NavDgpsBlock, 12>());
static_assert(is<NavSbasHead, 12>() && is<NavSbasBlock, 12>());
static_assert(is<NavHpposecef, 28>() && is<NavHpposllh, 36>() && is<NavCov, 64>());
static_assert(is<NavRelposned, 64>());
// Class 0x02.
static_assert(is<RxmRawHead, 8>() && is<RxmRawBlock, 24>() && is<RxmSfrb, 42>());
static_assert(is<RxmSfrbxHead, 8>() && is<RxmSfrbxWord, 4>());
static_assert(is<RxmRawxHead, 16>() && is<RxmRawxBlock, 32>());
static_assert(is<RxmSvsiHead, 8>() && is<RxmSvsiBlock, 6>());
// Class 0x06.
static_assert(is<CfgMsg, 8>() && is<CfgCfg, 12>());
static_assert(is<CfgNmea, 12>());
static_assert(is<CfgDat, 52>() && is<CfgPm2, 44>() && is<CfgUsb, 108>());
static_assert(is<CfgGnssHead, 4>() && is<CfgGnssBlock, 8>());
// Classes 0x0A, 0x0B, 0x0D.
static_assert(is<MonIoHead, 0>() && is<MonIoPort, 20>() && is<MonMsgpp, 120>());
static_assert(is<MonRxbuf, 24>() && is<MonTxbuf, 28>() && is<MonHw, 60>() && is<MonHw2, 28>());
static_assert(is<MonRxr, 1>() && is<MonRfHead, 4>() && is<MonRfBlock, 24>());
static_assert(is<AidIni, 48>() && is<AidHui, 72>());
static_assert(is<AidAlmHead, 8>() && is<AidAlm, 40>() && is<AidEphHead, 8>() && is<AidEph, 104>());
static_assert(is<TimTp, 16>() && is<TimTm2, 28>());

Bytes payload_of(std::span<const std::uint8_t> frame) {
  return {frame.begin() + kHeaderBytes, frame.end() - kChecksumBytes};
}

TEST(UbxMessages, RealNumbersAreIeee754LeastSignificantByteFirst) {
  const NavDgpsBlock block{.range_correction_m = -1.5F, .range_rate_correction_mps = 0.25F};
  std::array<std::uint8_t, NavDgpsBlock::kLength> bytes{};
  write_payload(block, bytes);
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 12>{0, 0, 0, 0, 0x00, 0x00, 0xC0, 0xBF, 0x00, 0x00,
                                                 0x80, 0x3E}));
  EXPECT_EQ(read_payload<NavDgpsBlock>(bytes), block);

  const RxmRawBlock raw{.carrier_phase_cycles = -2.0, .pseudorange_m = 1.0};
  std::array<std::uint8_t, RxmRawBlock::kLength> raw_bytes{};
  write_payload(raw, raw_bytes);
  EXPECT_EQ(raw_bytes[7], 0xC0);
  EXPECT_EQ(raw_bytes[15], 0x3F);
  EXPECT_EQ(raw_bytes[14], 0xF0);
  EXPECT_EQ(read_payload<RxmRawBlock>(raw_bytes), raw);
}

TEST(UbxMessages, NoRealNumberIsRefused) {
  NavCov cov;
  cov.position_covariance_ned_m2[0] = std::numeric_limits<float>::infinity();
  cov.velocity_covariance_ned_m2ps2[5] = std::numeric_limits<float>::denorm_min();
  const auto frame = encode(cov);
  EXPECT_EQ(*decode<NavCov>(*decode_frame(frame)), cov);
}

TEST(UbxMessages, LongerFormsBeginLikeTheShorter) {
  NavPvt92 pvt;
  pvt.year = 2026;
  pvt.latitude_e7deg = -123;
  pvt.flags3 = 0x0102;
  pvt.vehicle_heading_e5deg = -2;
  pvt.declination_e2deg = -3;
  pvt.declination_accuracy_e2deg = 0x0405;
  const Bytes longer = payload_of(encode(pvt));
  const Bytes shorter = payload_of(encode(static_cast<const NavPvt&>(pvt)));
  EXPECT_EQ(Bytes(longer.begin(), longer.begin() + 78),
            Bytes(shorter.begin(), shorter.begin() + 78));
  EXPECT_EQ(Bytes(longer.begin() + 78, longer.end()),
            (Bytes{0x02, 0x01, 0, 0, 0, 0, 0xFE, 0xFF, 0xFF, 0xFF, 0xFD, 0xFF, 0x05, 0x04}));
}

TEST(UbxMessages, RelativePositionStandsWhereTheDocumentsPutIt) {
  NavRelposned now;
  now.relative_ned_rest_e4m = {1, -1, 2};
  now.length_rest_e4m = 99;
  now.heading_accuracy_e5deg = 0x0D;
  now.flags = kRelativeHeadingValid;
  const Bytes v1 = payload_of(encode(now));
  EXPECT_EQ(v1[0], 1);
  EXPECT_EQ(v1[33], 0xFF);
  EXPECT_EQ(v1[35], 99);
  EXPECT_EQ(v1[52], 0x0D);
  EXPECT_EQ(v1[61], 1);
}

TEST(UbxBlocks, HeadTellsTheNumberOfBlocks) {
  std::array<NavSatBlock, 2> satellites{};
  satellites[0].residual_dm = -7;
  satellites[1].flags = kSatUsed | kSatRtcmCorrections;
  NavSatHead head;
  head.satellites = 2;
  std::array<std::uint8_t, frame_size<NavSatHead, NavSatBlock>(2)> out{};
  static_assert(out.size() == 8 + 8 + 2 * 12);
  ASSERT_EQ((encode_blocks<NavSatHead, NavSatBlock>(head, satellites, out)), out.size());
  const auto frame = decode_frame(out);
  ASSERT_TRUE(frame.ok());
  const auto again = decode_blocks<NavSatHead, NavSatBlock>(*frame);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again.consumed(), out.size());
  EXPECT_EQ(again->head(), head);
  ASSERT_EQ(again->size(), 2U);
  EXPECT_EQ((*again)[0], satellites[0]);
  EXPECT_EQ((*again)[1], satellites[1]);

  head.satellites = 3;
  EXPECT_EQ((encode_blocks<NavSatHead, NavSatBlock>(head, satellites, out)), 0U);
  head.satellites = 2;
  EXPECT_EQ((encode_blocks<NavSatHead, NavSatBlock>(head, satellites, std::span(out).first(39))),
            0U);
}

TEST(UbxBlocks, OtherLengthsAreMalformed) {
  Bytes payload(8 + 2 * 12);
  payload[5] = 2;
  const auto with_length = [&](std::size_t size) {
    return decode_blocks<NavSatHead, NavSatBlock>(
        {NavSatHead::kId, std::span(payload).first(size)});
  };
  EXPECT_TRUE(with_length(32).ok());
  for (const std::size_t size : {0U, 7U, 8U, 20U, 31U}) {
    EXPECT_TRUE(with_length(size).malformed()) << size;
  }
  EXPECT_TRUE((decode_blocks<NavSigHead, NavSigBlock>({NavSatHead::kId, payload}).malformed()));
}

TEST(UbxBlocks, WithoutCountTheLengthTellsIt) {
  std::array<MonIoPort, kMonitorPorts> ports{};
  ports[5].sent_bytes = 7;
  std::array<std::uint8_t, frame_size<MonIoHead, MonIoPort>(kMonitorPorts)> out{};
  ASSERT_EQ((encode_blocks<MonIoHead, MonIoPort>({}, ports, out)), 128U);
  const auto again = decode_blocks<MonIoHead, MonIoPort>(*decode_frame(out));
  ASSERT_TRUE(again.ok());
  ASSERT_EQ(again->size(), kMonitorPorts);
  EXPECT_EQ((*again)[5], ports[5]);
}

// Recorded from a NEO-7P.
TEST(UbxBlocks, RecordedSystemsOfANeo7p) {
  const Bytes payload{0x00, 0x16, 0x16, 0x04, 0x00, 0x04, 0xFF, 0x00, 0x01, 0x00, 0x00, 0x00,
                      0x01, 0x01, 0x03, 0x00, 0x01, 0x00, 0x00, 0x00, 0x05, 0x00, 0x03, 0x00,
                      0x01, 0x00, 0x00, 0x00, 0x06, 0x08, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00};
  const auto systems = decode_blocks<CfgGnssHead, CfgGnssBlock>({CfgGnssHead::kId, payload});
  ASSERT_TRUE(systems.ok());
  EXPECT_EQ(systems->head().hardware_channels, 22);
  EXPECT_EQ((*systems)[3], (CfgGnssBlock{6, 8, 255, 0}));
}

TEST(UbxInformation, TextIsNotTerminated) {
  std::array<std::uint8_t, 32> out{};
  const std::size_t size = encode_information({InformationKind::warning, "ANTSTATUS=OPEN"}, out);
  ASSERT_EQ(size, 22U);
  const auto frame = decode_frame(std::span(out).first(size));
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->id, (MessageId{0x04, 0x01}));
  const auto text = decode_information(*frame);
  ASSERT_TRUE(text.ok());
  EXPECT_EQ(*text, (Information{InformationKind::warning, "ANTSTATUS=OPEN"}));
  EXPECT_TRUE(decode_information({{0x04, 0x05}, {}}).malformed());
  EXPECT_TRUE(decode_information({{0x05, 0x00}, {}}).malformed());
  EXPECT_EQ(
      encode_information({InformationKind::warning, "ANTSTATUS=OPEN"}, std::span(out).first(21)),
      0U);
}

}  // namespace
}  // namespace rigwire::protocols::ubx
