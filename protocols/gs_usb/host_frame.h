// CAN frames between a gs_usb adapter and its host, over the two bulk endpoints: one frame per
// transfer.
//
// Sources: as in requests.h. Least significant byte first:
//
//   offset  bytes
//     0      4    echo number: of the host's choice for a frame to be sent, and returned with that
//                 frame when it has been; FFFFFFFF for a frame received from the bus
//     4      4    identifier, with SocketCAN's flags 80000000 29-bit, 40000000 remote,
//                 20000000 error frame
//     8      1    data length code
//     9      1    channel
//    10      1    flags: 1 frames were lost before this one, 2 CAN FD, 4 bit rate switched,
//                 8 error state indicator
//    11      1    reserved, 0
//    12      8    data (64 of a CAN FD frame)
//    20      4    time stamp in microseconds; from the adapter only, and only if asked for
//
// A receiver that asked for padding (Feature::kPadded) gets 32 bytes, the rest zero. CAN FD frames
// are not modelled: the decoder refuses them.
//
// Worked example: frame 0CF02980#00007D00007DCC00 to be sent as number 3:
//   03000000 8029F08C 08 00 00 00 00007D00007DCC00
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::gs_usb {

inline constexpr std::uint8_t kEndpointToHost = 0x81;
inline constexpr std::uint8_t kEndpointToDevice = 0x02;
/// Max packet size of both endpoints, without CAN FD.
inline constexpr std::size_t kPacketBytes = 32;

/// Echo number of what was received from the bus.
inline constexpr std::uint32_t kReceived = 0xFFFFFFFF;

/// echo, identifier; length, channel, flags, reserved; data.
inline constexpr std::size_t kFrameBytes = 4 + 4 + (1 + 1 + 1 + 1) + 8;
static_assert(kFrameBytes == 20);
inline constexpr std::size_t kStampedFrameBytes = kFrameBytes + 4;

struct HostFrame {
  static constexpr std::uint32_t kExtended = 0x80000000;
  static constexpr std::uint32_t kRemote = 0x40000000;
  static constexpr std::uint32_t kError = 0x20000000;
  static constexpr std::uint8_t kOverflow = 1U << 0;
  static constexpr std::uint8_t kFlexibleDataRate = 1U << 1;

  std::uint32_t echo = kReceived;
  std::uint32_t identifier = 0;  ///< With flags.
  std::uint8_t length_code = 0;  ///< Values above 8 mean 8 bytes of data.
  std::uint8_t channel = 0;
  std::uint8_t flags = 0;
  std::array<std::uint8_t, 8> data{};
  std::optional<std::uint32_t> time_stamp_us;

  friend bool operator==(const HostFrame&, const HostFrame&) = default;
};

/// Returns the frame that a controller sends for this; bits that its format does not have are left
/// out. nullopt for an error frame, which cannot be sent.
[[nodiscard]] std::optional<can::Frame> to_can(const HostFrame& frame);
/// Returns the frame as received from the bus.
[[nodiscard]] HostFrame from_can(const can::Frame& frame);

struct HostFrameBytes {
  std::array<std::uint8_t, kPacketBytes> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> span() const { return std::span(bytes).first(size); }
};

/// With its time stamp if it has one.
[[nodiscard]] HostFrameBytes encode_frame(const HostFrame& frame, bool padded = false);

/// The beginning of `bytes`. `stamped`: a time stamp follows the data.
[[nodiscard]] Decoded<HostFrame> decode_frame(std::span<const std::uint8_t> bytes, bool stamped);

}  // namespace rigwire::protocols::gs_usb
