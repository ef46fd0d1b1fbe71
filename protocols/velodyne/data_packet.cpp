#include "protocols/velodyne/data_packet.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::size_t kFlagAt = 0;
constexpr std::size_t kAzimuthAt = kFlagAt + 2;
constexpr std::size_t kChannelsAt = kAzimuthAt + 2;
constexpr std::size_t kDistanceAt = 0;
constexpr std::size_t kReflectivityAt = kDistanceAt + 2;
constexpr std::size_t kTimestampAt = kBlocksPerPacket * kBlockSize;
constexpr std::size_t kReturnModeAt = kTimestampAt + 4;
constexpr std::size_t kProductIdAt = kReturnModeAt + 1;
static_assert(kChannelsAt + kChannelsPerBlock * kChannelSize == kBlockSize);
static_assert(kReflectivityAt + 1 == kChannelSize);
static_assert(kProductIdAt + 1 == kDataPacketSize);

constexpr std::size_t block_at(std::size_t block) {
  return block * kBlockSize;
}
constexpr std::size_t channel_at(std::size_t block, std::size_t channel) {
  return block_at(block) + kChannelsAt + channel * kChannelSize;
}

bool known_flag(std::uint16_t flag, std::size_t block) {
  return (flag == kFlagEmpty && block >= kFirstEmptyBlock) || flag == kFlagLasers0To31 ||
         flag == kFlagLasers32To63 || flag == kFlagLasers64To95 || flag == kFlagLasers96To127;
}

}  // namespace

void DataPacketWriter::flag(std::size_t block, std::uint16_t flag) {
  store_little(bytes_, block_at(block) + kFlagAt, flag);
}

void DataPacketWriter::azimuth(std::size_t block, std::uint16_t counts) {
  assert(counts < kAzimuthCounts);
  store_little(bytes_, block_at(block) + kAzimuthAt, counts);
}

void DataPacketWriter::channels(std::size_t block, std::size_t first,
                                std::span<const ChannelWord> words) {
  // Four channels of three bytes fill three words.
  static_assert(kChannelSize == 3);
  assert(words.size() % 4 == 0 && first + words.size() <= kChannelsPerBlock);
  for (std::size_t c = 0; c < words.size(); c += 4) {
    const auto group = bytes_.subspan(channel_at(block, first + c), 4 * kChannelSize);
    store_little(group, 0, words[c] | words[c + 1] << 24U);
    store_little(group, 4, words[c + 1] >> 8U | words[c + 2] << 16U);
    store_little(group, 8, words[c + 2] >> 16U | words[c + 3] << 8U);
  }
}

void DataPacketWriter::timestamp(std::uint32_t us) {
  store_little(bytes_, kTimestampAt, us);
}

void DataPacketWriter::factory_bytes(std::uint8_t return_mode, std::uint8_t product_id) {
  bytes_[kReturnModeAt] = return_mode;
  bytes_[kProductIdAt] = product_id;
}

void encode(const DataPacket& packet, std::span<std::uint8_t, kDataPacketSize> bytes) {
  DataPacketWriter write(bytes);
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    const Block& block = packet.blocks[b];
    std::array<ChannelWord, kChannelsPerBlock> words;
    std::ranges::transform(block.channels, words.begin(), channel_word);
    write.flag(b, block.flag);
    write.azimuth(b, block.azimuth_counts);
    write.channels(b, 0, words);
  }
  write.timestamp(packet.timestamp_us);
  write.factory_bytes(packet.return_mode_byte, packet.product_id);
}

Decoded<DataPacket> decode_data_packet(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kDataPacketSize) {
    return Incomplete{kDataPacketSize, bytes.size()};
  }
  if (bytes.size() > kDataPacketSize) {
    return Malformed{"a data packet has 1206 bytes, this datagram has more", kDataPacketSize};
  }
  DataPacket packet;
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    Block& block = packet.blocks[b];
    block.flag = load_little<std::uint16_t>(bytes, block_at(b) + kFlagAt);
    if (!known_flag(block.flag, b)) {
      return Malformed{"unknown block flag", block_at(b) + kFlagAt};
    }
    block.azimuth_counts = load_little<std::uint16_t>(bytes, block_at(b) + kAzimuthAt);
    if (block.azimuth_counts >= kAzimuthCounts) {
      return Malformed{"azimuth of 36000 or above", block_at(b) + kAzimuthAt};
    }
    for (std::size_t c = 0; c < kChannelsPerBlock; ++c) {
      block.channels[c].distance_counts =
          load_little<std::uint16_t>(bytes, channel_at(b, c) + kDistanceAt);
      block.channels[c].reflectivity = bytes[channel_at(b, c) + kReflectivityAt];
    }
  }
  packet.timestamp_us = load_little<std::uint32_t>(bytes, kTimestampAt);
  packet.return_mode_byte = bytes[kReturnModeAt];
  packet.product_id = bytes[kProductIdAt];
  return {packet, kDataPacketSize};
}

}  // namespace rigwire::protocols::velodyne
