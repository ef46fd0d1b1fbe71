// The Velodyne data packet: 1206 bytes of UDP payload, default port 2368, all fields little-endian.
//
//   offset 0 + 100 b   block b = 0..11: flag u16, azimuth u16, then 32 channels of
//                      distance u16 and reflectivity u8
//   offset 1200        timestamp u32: microseconds past the hour at the first firing
//   offset 1204, 1205  factory bytes: return mode, product id (HDL-64E: status type and value,
//                      status_channel.h)
//
// The order of the lasers in a block: packet_layout.h.
//
// Sources: HDL-32E user's manual 63-9113 Rev. H, "Packet format"; VLP-16 user's manual 63-9243
// Rev. D, section 9.3 (factory bytes). Units older than firmware 2.2.20.0 send both factory bytes
// as zero. Format page: docs/devices/velodyne-packets.md; a worked example:
// docs/devices/velodyne-hdl-32e.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/result.h"

namespace rigwire::protocols::velodyne {

inline constexpr std::size_t kBlocksPerPacket = 12;
inline constexpr std::size_t kChannelsPerBlock = 32;

/// Sizes of the parts, in bytes.
inline constexpr std::size_t kChannelSize = 2     // distance
                                            + 1;  // reflectivity
inline constexpr std::size_t kBlockSize = 2       // flag
                                          + 2     // azimuth
                                          + kChannelsPerBlock * kChannelSize;
inline constexpr std::size_t kDataPacketSize = kBlocksPerPacket * kBlockSize  //
                                               + 4                            // timestamp
                                               + 1                            // return mode
                                               + 1;                           // product id
static_assert(kBlockSize == 100);
static_assert(kDataPacketSize == 1206);

/// Flags say which bank of 32 lasers a block belongs to; on the wire low byte first (FF EE).
inline constexpr std::uint16_t kFlagLasers0To31 = 0xEEFF;
inline constexpr std::uint16_t kFlagLasers32To63 = 0xDDFF;
inline constexpr std::uint16_t kFlagLasers64To95 = 0xCCFF;
inline constexpr std::uint16_t kFlagLasers96To127 = 0xBBFF;
/// The last four blocks of a VLS-128 that sends two returns hold nothing but an azimuth.
inline constexpr std::uint16_t kFlagEmpty = 0x0000;
inline constexpr std::size_t kFirstEmptyBlock = 8;

/// Azimuth counts of a full turn, 0.01 degree each. 36000 itself is never sent.
inline constexpr std::uint16_t kAzimuthCounts = 36000;

enum class ReturnMode : std::uint8_t { strongest = 0x37, last = 0x38, dual = 0x39 };

struct Channel {
  std::uint16_t distance_counts = 0;  ///< Times the model's unit; 0 = nothing came back.
  std::uint8_t reflectivity = 0;      ///< 0..100 diffuse per cent, 101..255 retro-reflector. 0 is
                                      ///< legal with a distance, so ask the distance.
  friend bool operator==(const Channel&, const Channel&) = default;
};

/// A channel as its bytes are on the wire, the first one lowest: distance in bits 0 .. 15,
/// reflectivity in bits 16 .. 23; the rest is 0.
using ChannelWord = std::uint32_t;

[[nodiscard]] constexpr ChannelWord channel_word(const Channel& channel) {
  return channel.distance_counts | static_cast<ChannelWord>(channel.reflectivity) << 16U;
}

struct Block {
  std::uint16_t flag = kFlagLasers0To31;
  std::uint16_t azimuth_counts = 0;  ///< 0 .. 35999, of the block's first firing; clockwise.
  std::array<Channel, kChannelsPerBlock> channels{};

  friend bool operator==(const Block&, const Block&) = default;
};

struct DataPacket {
  std::array<Block, kBlocksPerPacket> blocks{};
  std::uint32_t timestamp_us = 0;     ///< Past the hour, of the first firing.
  std::uint8_t return_mode_byte = 0;  ///< A ReturnMode, or 0 from old units.
  std::uint8_t product_id = 0;        ///< See model.h; 0 from old units.

  friend bool operator==(const DataPacket&, const DataPacket&) = default;
};

/// Writes a packet in place, each part when it is known; nothing else touches the bytes, which must
/// outlive it. Blocks are 0 .. 11.
class DataPacketWriter {
 public:
  explicit DataPacketWriter(std::span<std::uint8_t, kDataPacketSize> bytes) : bytes_(bytes) {}

  void flag(std::size_t block, std::uint16_t flag);
  /// Below kAzimuthCounts (asserted).
  void azimuth(std::size_t block, std::uint16_t counts);
  /// From `first` on. `first` is within the block, with all words; their number is a multiple of 4.
  void channels(std::size_t block, std::size_t first, std::span<const ChannelWord> words);
  void timestamp(std::uint32_t us);
  void factory_bytes(std::uint8_t return_mode, std::uint8_t product_id);

 private:
  std::span<std::uint8_t, kDataPacketSize> bytes_;
};

/// Writes the whole packet. Azimuths must be below kAzimuthCounts (asserted).
void encode(const DataPacket& packet, std::span<std::uint8_t, kDataPacketSize> bytes);

/// Reads one datagram. Fewer bytes than a packet are incomplete; more, an unknown flag (kFlagEmpty
/// is known from block 8 on) or an azimuth of 36000 and above are malformed. Timestamps past 3600 s
/// are passed on: real units send them for some tens of milliseconds around the hour.
Decoded<DataPacket> decode_data_packet(std::span<const std::uint8_t> bytes);

}  // namespace rigwire::protocols::velodyne
