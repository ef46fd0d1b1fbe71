#include "protocols/velodyne/data_packet.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::protocols::velodyne {
namespace {

using Bytes = std::array<std::uint8_t, kDataPacketSize>;

DataPacket sample() {
  DataPacket packet;
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    packet.blocks[b].azimuth_counts = static_cast<std::uint16_t>((35950 + 17 * b) % kAzimuthCounts);
    for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
      packet.blocks[b].channels[c] = {static_cast<std::uint16_t>(500 * b + c),
                                      static_cast<std::uint8_t>(c)};
    }
  }
  packet.timestamp_us = 3599999999U;
  packet.return_mode_byte = static_cast<std::uint8_t>(ReturnMode::strongest);
  packet.product_id = 0x21;
  return packet;
}

TEST(VelodyneDataPacket, DecodesWhatItEncoded) {
  Bytes bytes{};
  encode(sample(), bytes);
  const auto decoded = decode_data_packet(bytes);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, sample());
  EXPECT_EQ(decoded.consumed(), kDataPacketSize);
}

TEST(VelodyneDataPacket, BytesStandWhereTheManualPutsThem) {
  DataPacket packet = sample();
  packet.blocks[1].azimuth_counts = 0x1234;
  packet.blocks[1].channels[31] = {0xABCD, 0x5A};
  packet.timestamp_us = 0x01020304;
  Bytes bytes{};
  encode(packet, bytes);
  EXPECT_EQ(bytes[0], 0xFF);
  EXPECT_EQ(bytes[1], 0xEE);
  EXPECT_EQ(bytes[102], 0x34);
  EXPECT_EQ(bytes[103], 0x12);
  EXPECT_EQ(bytes[100 + 4 + 31 * 3], 0xCD);
  EXPECT_EQ(bytes[100 + 4 + 31 * 3 + 1], 0xAB);
  EXPECT_EQ(bytes[199], 0x5A);
  EXPECT_EQ(bytes[1200], 0x04);
  EXPECT_EQ(bytes[1203], 0x01);
  EXPECT_EQ(bytes[1204], 0x37);
  EXPECT_EQ(bytes[1205], 0x21);
}

TEST(VelodyneDataPacket, WriterTouchesNothingButThePartsThatItIsGiven) {
  Bytes bytes;
  bytes.fill(0xA5);
  DataPacketWriter write(bytes);
  std::array<ChannelWord, 16> words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] =
        channel_word({static_cast<std::uint16_t>(0xF0C1 + i), static_cast<std::uint8_t>(0x80 + i)});
  }
  write.channels(11, 16, words);
  for (std::size_t i = 0; i < kDataPacketSize; ++i) {
    const std::size_t from = i - (11 * 100 + 4 + 16 * 3);  // Wraps before the first one.
    const std::size_t word = from / 3;
    const std::size_t expected = word >= 16      ? 0xA5
                                 : from % 3 == 0 ? 0xC1 + word
                                 : from % 3 == 1 ? 0xF0
                                                 : 0x80 + word;
    ASSERT_EQ(bytes[i], expected) << i;
  }
}

TEST(VelodyneDataPacket, TellsIncompleteFromMalformed) {
  Bytes bytes{};
  encode(sample(), bytes);
  const auto cut = decode_data_packet(std::span(bytes).first(1205));
  ASSERT_TRUE(cut.incomplete());
  EXPECT_EQ(cut.shortage().needed, 1206U);
  EXPECT_EQ(cut.shortage().had, 1205U);
  std::vector<std::uint8_t> longer(bytes.begin(), bytes.end());
  longer.push_back(0);
  EXPECT_TRUE(decode_data_packet(longer).malformed());
  Bytes flag = bytes;
  flag[300] = 0;
  ASSERT_TRUE(decode_data_packet(flag).malformed());
  EXPECT_EQ(decode_data_packet(flag).fault().offset, 300U);
  Bytes azimuth = bytes;
  azimuth[2] = 0xA0;  // 36000 = 0x8CA0
  azimuth[3] = 0x8C;
  ASSERT_TRUE(decode_data_packet(azimuth).malformed());
  EXPECT_EQ(decode_data_packet(azimuth).fault().offset, 2U);
  EXPECT_TRUE(decode_data_packet({}).incomplete());
}

TEST(VelodyneDataPacket, EmptyBlocksStandOnlyWhereAVls128LeavesThem) {
  DataPacket packet = sample();
  packet.blocks[11].flag = kFlagEmpty;
  Bytes bytes{};
  encode(packet, bytes);
  EXPECT_TRUE(decode_data_packet(bytes).ok());
  packet.blocks[7].flag = kFlagEmpty;
  encode(packet, bytes);
  EXPECT_TRUE(decode_data_packet(bytes).malformed());
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
