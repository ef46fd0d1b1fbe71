#include "protocols/rtcm3/frame.h"

#include <algorithm>
#include <cassert>

#include "protocols/crc24q.h"

namespace rigwire::protocols::rtcm3 {

std::uint16_t FrameView::message() const {
  return payload.size() < 2 ? std::uint16_t{0}
                            : static_cast<std::uint16_t>(payload[0] << 4U | payload[1] >> 4U);
}

std::uint16_t FrameView::second_field() const {
  return payload.size() < 3 ? std::uint16_t{0}
                            : static_cast<std::uint16_t>((payload[1] & 0x0FU) << 8U | payload[2]);
}

Decoded<FrameView> decode_frame(std::span<const std::uint8_t> bytes) {
  constexpr unsigned kReserved = 0xFC;
  if (!bytes.empty() && bytes[0] != kPreamble) {
    return Malformed{"RTCM 3 preamble", 0};
  }
  if (bytes.size() > 1 && (bytes[1] & kReserved) != 0) {
    return Malformed{"RTCM 3 reserved bits", 1};
  }
  if (bytes.size() < kHeaderBytes) {
    return Incomplete{kHeaderBytes + kChecksumBytes, bytes.size()};
  }
  const std::size_t length = (bytes[1] & 3U) << 8U | bytes[2];
  const std::size_t total = kHeaderBytes + length + kChecksumBytes;
  if (bytes.size() < total) {
    return Incomplete{total, bytes.size()};
  }
  // The remainder of a frame with its own checksum is 0.
  if (crc24q(bytes.first(total)) != 0) {
    return Malformed{"RTCM 3 checksum", kHeaderBytes + length};
  }
  return {FrameView{bytes.subspan(kHeaderBytes, length)}, total};
}

std::size_t encode_frame(std::span<const std::uint8_t> payload, std::span<std::uint8_t> out) {
  const std::size_t checked = kHeaderBytes + payload.size();
  assert(payload.size() <= kGreatestPayload && out.size() >= checked + kChecksumBytes);
  out[0] = kPreamble;
  out[1] = static_cast<std::uint8_t>(payload.size() >> 8U);
  out[2] = static_cast<std::uint8_t>(payload.size());
  std::ranges::copy(payload, out.begin() + kHeaderBytes);
  const std::uint32_t checksum = crc24q(out.first(checked));
  for (std::size_t i = 0; i < kChecksumBytes; ++i) {
    out[checked + i] = static_cast<std::uint8_t>(checksum >> (16U - 8U * i));
  }
  return checked + kChecksumBytes;
}

}  // namespace rigwire::protocols::rtcm3
