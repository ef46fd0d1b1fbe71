#include "protocols/velodyne/position_packet.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::velodyne {
namespace {

constexpr std::size_t kInertialAt = kPositionHeadSize;
constexpr std::size_t kTimestampAt =
    kInertialAt + kInertialGroups * kInertialGroupSize + kPositionGapSize;
constexpr std::size_t kPulseStateAt = kTimestampAt + 4;
constexpr std::size_t kNmeaAt = kPulseStateAt + 1 + 3;
static_assert(kTimestampAt == 198 && kNmeaAt == 206);
static_assert(kNmeaAt + kNmeaSize == kPositionPacketSize);

constexpr std::uint16_t kTwelveBits = 0x0FFF;

std::uint16_t pack_12(std::int16_t counts) {
  assert(counts >= -2048 && counts <= 2047);
  return static_cast<std::uint16_t>(static_cast<std::uint16_t>(counts) & kTwelveBits);
}

std::int16_t unpack_12(std::uint16_t field) {
  const int counts = field & kTwelveBits;
  return static_cast<std::int16_t>(counts >= 2048 ? counts - 4096 : counts);
}

}  // namespace

std::string_view PositionPacket::sentence() const {
  const auto end = std::ranges::find(nmea, '\0');
  return {nmea.data(), static_cast<std::size_t>(end - nmea.begin())};
}

void PositionPacket::set_sentence(std::string_view text) {
  assert(text.size() <= nmea.size() && text.find('\0') == std::string_view::npos);
  nmea.fill('\0');
  std::ranges::copy(text, nmea.begin());
}

void encode(const PositionPacket& packet, std::span<std::uint8_t, kPositionPacketSize> bytes) {
  std::ranges::fill(bytes, std::uint8_t{0});
  for (std::size_t g = 0; g < kInertialGroups; ++g) {
    const std::size_t at = kInertialAt + g * kInertialGroupSize;
    store_little(bytes, at, pack_12(packet.inertial[g].gyro));
    store_little(bytes, at + 2, pack_12(packet.inertial[g].temperature));
    store_little(bytes, at + 4, pack_12(packet.inertial[g].acceleration_x));
    store_little(bytes, at + 6, pack_12(packet.inertial[g].acceleration_y));
  }
  store_little(bytes, kTimestampAt, packet.timestamp_us);
  bytes[kPulseStateAt] = static_cast<std::uint8_t>(packet.pulse_state);
  for (std::size_t i = 0; i < kNmeaSize; ++i) {
    bytes[kNmeaAt + i] = static_cast<std::uint8_t>(packet.nmea[i]);
  }
}

Decoded<PositionPacket> decode_position_packet(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kPositionPacketSize) {
    return Incomplete{kPositionPacketSize, bytes.size()};
  }
  if (bytes.size() > kPositionPacketSize) {
    return Malformed{"a position packet has 512 bytes, this datagram has more",
                     kPositionPacketSize};
  }
  for (std::size_t i = 0; i < kPositionHeadSize; ++i) {
    if (bytes[i] != 0) {
      return Malformed{"the first 14 bytes must be zero", i};
    }
  }
  if (bytes[kPulseStateAt] > static_cast<std::uint8_t>(PulseState::error)) {
    return Malformed{"unknown state of the pulse input", kPulseStateAt};
  }
  PositionPacket packet;
  for (std::size_t g = 0; g < kInertialGroups; ++g) {
    const std::size_t at = kInertialAt + g * kInertialGroupSize;
    packet.inertial[g] = {unpack_12(load_little<std::uint16_t>(bytes, at)),
                          unpack_12(load_little<std::uint16_t>(bytes, at + 2)),
                          unpack_12(load_little<std::uint16_t>(bytes, at + 4)),
                          unpack_12(load_little<std::uint16_t>(bytes, at + 6))};
  }
  packet.timestamp_us = load_little<std::uint32_t>(bytes, kTimestampAt);
  packet.pulse_state = static_cast<PulseState>(bytes[kPulseStateAt]);
  bool ended = false;
  for (std::size_t i = 0; i < kNmeaSize; ++i) {
    const std::uint8_t byte = bytes[kNmeaAt + i];
    if (ended && byte != 0) {
      return Malformed{"text behind the end of the sentence", kNmeaAt + i};
    }
    ended = ended || byte == 0;
    packet.nmea[i] = static_cast<char>(byte);
  }
  return {packet, kPositionPacketSize};
}

}  // namespace rigwire::protocols::velodyne
