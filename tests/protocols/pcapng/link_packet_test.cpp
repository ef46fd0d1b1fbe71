#include "protocols/pcapng/link_packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "protocols/bytes.h"

namespace rigwire::protocols::pcapng {
namespace {

constexpr IpEnd kDevice{0x7F00'0001, 2368};
constexpr IpEnd kClient{0x7F00'0002, 40'000};

std::uint32_t ones_complement(std::span<const std::uint8_t> bytes, std::uint32_t total) {
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    total += load_big<std::uint16_t>(bytes, i);
  }
  while (total > 0xFFFF) {
    total = (total & 0xFFFF) + (total >> 16);
  }
  return total;
}

TEST(LinkPacket, AFrameIsLaidOutAsSocketCanHasIt) {
  const can::Frame frame{0x18FEF100, true, false, 3, {0xF3, 0, 0x64}};
  const CanPacket expected{0x98, 0xFE, 0xF1, 0x00, 3, 0, 0, 0, 0xF3, 0, 0x64, 0, 0, 0, 0, 0};
  EXPECT_EQ(can_packet(frame), expected);
  for (const can::Frame& each :
       {frame, can::Frame{0x7FF, false, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}},
        can::Frame{0x123, false, true, 4, {}}, can::Frame{0, false, false, 0, {}}}) {
    const auto again = can_frame(can_packet(each));
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(*again, each);
  }
  const CanPacket error = can_packet(can::ErrorFrame{can::kErrorFlag | 0x40, {}});
  EXPECT_TRUE(is_error_frame(error));
  EXPECT_FALSE(is_error_frame(expected));
  EXPECT_TRUE(can_frame(error).malformed());
  EXPECT_TRUE(can_frame(std::span(expected).first(10)).incomplete());
}

TEST(LinkPacket, ASerialLineHasTheHeadOfRtac) {
  Bytes packet;
  append_serial(packet, 1'780'300'800'123'456'789, Direction::inbound, Bytes{0xB5, 0x62});
  const Bytes expected{0x6A, 0x1D, 0x3C, 0x00, 0, 1, 0xE2, 0x40, 2, 0, 0, 0, 0xB5, 0x62};
  EXPECT_EQ(packet, expected);
  EXPECT_EQ(serial_bytes(packet).size(), 2U);
  EXPECT_TRUE(serial_bytes(std::span(packet).first(11)).empty());
}

TEST(LinkPacket, ADatagramHasHeadsOf42BytesAsDriversOfLidarsSkipThem) {
  Bytes packet;
  const Bytes payload(1206, 0xEE);
  append_udp(packet, kDevice, kClient, payload);
  EXPECT_EQ(packet.size(), 42U + 1206U);
  EXPECT_EQ(ones_complement(std::span(packet).subspan(14, 20), 0), 0xFFFFU);
  const auto udp = udp_packet(packet);
  ASSERT_TRUE(udp.ok());
  EXPECT_EQ(udp->from, kDevice);
  EXPECT_EQ(udp->to, kClient);
  EXPECT_TRUE(std::ranges::equal(udp->bytes, payload));
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_TRUE(udp_packet(std::span(packet).first(size)).incomplete()) << size;
  }
  Bytes tagged(packet.begin(), packet.begin() + 12);
  tagged.insert(tagged.end(), {0x81, 0, 0, 7});
  tagged.insert(tagged.end(), packet.begin() + 12, packet.end());
  ASSERT_TRUE(udp_packet(tagged).ok());
  EXPECT_EQ(udp_packet(tagged)->to, kClient);
  packet[14 + 6] = 0x20;  // "more fragments"
  EXPECT_TRUE(udp_packet(packet).malformed());
}

TEST(LinkPacket, AConversationCountsItsBytesAndChecksThem) {
  TcpConversation tcp(kClient, kDevice);
  struct Segment {
    std::uint16_t from;
    std::uint32_t sequence;
    std::uint32_t acknowledged;
    std::uint8_t flags;
    std::size_t bytes;
  };
  std::vector<Segment> seen;
  const auto use = [&](TcpConversation::Side, std::span<const std::uint8_t> packet) {
    const auto ip = packet.subspan(14);
    const auto segment = ip.subspan(20);
    const std::uint32_t pseudo = 6 + static_cast<std::uint32_t>(segment.size());
    Bytes even(segment.begin(), segment.end());
    even.insert(even.end(), ip.begin() + 12, ip.begin() + 20);
    if (segment.size() % 2 != 0) {
      even.insert(even.begin() + static_cast<std::ptrdiff_t>(segment.size()), 0);
    }
    EXPECT_EQ(ones_complement(even, pseudo), 0xFFFFU);
    seen.push_back({load_big<std::uint16_t>(segment, 0), load_big<std::uint32_t>(segment, 4),
                    load_big<std::uint32_t>(segment, 8), segment[13], segment.size() - 20});
  };
  using Side = TcpConversation::Side;
  tcp.open(use);
  tcp.data(Side::client, Bytes(12), use);
  tcp.data(Side::server, Bytes(70'001), use);
  tcp.finish(Side::client, use);
  ASSERT_EQ(seen.size(), 3U + 1U + 2U + 2U);
  EXPECT_EQ(seen[0].flags, 0x02);
  EXPECT_EQ(seen[1].flags, 0x12);
  EXPECT_EQ(seen[1].acknowledged, 1U);
  EXPECT_EQ(seen[3].sequence, 1U);
  EXPECT_EQ(seen[3].bytes, 12U);
  EXPECT_EQ(seen[4].from, kDevice.port);
  EXPECT_EQ(seen[4].acknowledged, 13U);
  EXPECT_EQ(seen[4].bytes + seen[5].bytes, 70'001U);
  EXPECT_EQ(seen[5].sequence, 1U + seen[4].bytes);
  EXPECT_EQ(seen[6].sequence, 13U);
  EXPECT_EQ(seen[6].flags, 0x11);
  EXPECT_EQ(seen[7].acknowledged, 14U);
}

}  // namespace
}  // namespace rigwire::protocols::pcapng
