#include "protocols/gs_usb/host_frame.h"

#include <algorithm>

#include "protocols/bytes.h"

namespace rigwire::protocols::gs_usb {

namespace {

constexpr std::size_t kEcho = 0;
constexpr std::size_t kIdentifier = 4;
constexpr std::size_t kLengthCode = 8;
constexpr std::size_t kChannel = 9;
constexpr std::size_t kFlags = 10;
constexpr std::size_t kData = 12;
constexpr std::size_t kTimeStamp = 20;

constexpr std::uint32_t kBaseMask = 0x7FF;
constexpr std::uint32_t kExtendedMask = 0x1FFFFFFF;

}  // namespace

std::optional<can::Frame> to_can(const HostFrame& frame) {
  if ((frame.identifier & HostFrame::kError) != 0) {
    return std::nullopt;
  }
  can::Frame sent;
  sent.extended = (frame.identifier & HostFrame::kExtended) != 0;
  sent.remote = (frame.identifier & HostFrame::kRemote) != 0;
  sent.id = frame.identifier & (sent.extended ? kExtendedMask : kBaseMask);
  sent.length = std::min<std::uint8_t>(frame.length_code & 0x0FU, 8);
  if (!sent.remote) {
    std::copy_n(frame.data.begin(), sent.length, sent.data.begin());
  }
  return sent;
}

HostFrame from_can(const can::Frame& frame) {
  HostFrame received;
  received.identifier = frame.id | (frame.extended ? HostFrame::kExtended : 0U) |
                        (frame.remote ? HostFrame::kRemote : 0U);
  received.length_code = frame.length;
  std::ranges::copy(frame.payload(), received.data.begin());
  return received;
}

HostFrameBytes encode_frame(const HostFrame& frame, bool padded) {
  HostFrameBytes out;
  const std::span<std::uint8_t> bytes = out.bytes;
  store_little(bytes, kEcho, frame.echo);
  store_little(bytes, kIdentifier, frame.identifier);
  bytes[kLengthCode] = frame.length_code;
  bytes[kChannel] = frame.channel;
  bytes[kFlags] = frame.flags;
  std::ranges::copy(frame.data, bytes.begin() + kData);
  out.size = kFrameBytes;
  if (frame.time_stamp_us) {
    store_little(bytes, kTimeStamp, *frame.time_stamp_us);
    out.size = kStampedFrameBytes;
  }
  if (padded) {
    out.size = kPacketBytes;
  }
  return out;
}

Decoded<HostFrame> decode_frame(std::span<const std::uint8_t> bytes, bool stamped) {
  const std::size_t size = stamped ? kStampedFrameBytes : kFrameBytes;
  if (bytes.size() < size) {
    return Incomplete{size, bytes.size()};
  }
  if ((bytes[kFlags] & HostFrame::kFlexibleDataRate) != 0) {
    return Malformed{"CAN FD frame", kFlags};
  }
  HostFrame frame;
  frame.echo = load_little<std::uint32_t>(bytes, kEcho);
  frame.identifier = load_little<std::uint32_t>(bytes, kIdentifier);
  frame.length_code = bytes[kLengthCode];
  frame.channel = bytes[kChannel];
  frame.flags = bytes[kFlags];
  std::ranges::copy(bytes.subspan(kData, frame.data.size()), frame.data.begin());
  if (stamped) {
    frame.time_stamp_us = load_little<std::uint32_t>(bytes, kTimeStamp);
  }
  return {frame, size};
}

}  // namespace rigwire::protocols::gs_usb
