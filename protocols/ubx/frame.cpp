#include "protocols/ubx/frame.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::ubx {

Checksum checksum(std::span<const std::uint8_t> bytes) {
  Checksum sum;
  for (const std::uint8_t byte : bytes) {
    sum.a = static_cast<std::uint8_t>(sum.a + byte);
    sum.b = static_cast<std::uint8_t>(sum.b + sum.a);
  }
  return sum;
}

Decoded<FrameView> decode_frame(std::span<const std::uint8_t> bytes, std::size_t maximum_payload) {
  if (!bytes.empty() && bytes[0] != kSync1) {
    return Malformed{"no UBX sync character 0xB5", 0};
  }
  if (bytes.size() > 1 && bytes[1] != kSync2) {
    return Malformed{"no UBX sync character 0x62", 1};
  }
  if (bytes.size() < kHeaderBytes) {
    return Incomplete{kOverheadBytes, bytes.size()};
  }
  const std::size_t length = load_little<std::uint16_t>(bytes, 4);
  if (length > maximum_payload) {
    return Malformed{"UBX payload longer than the receiver takes", 4};
  }
  const std::size_t total = kOverheadBytes + length;
  if (bytes.size() < total) {
    return Incomplete{total, bytes.size()};
  }
  const Checksum expected = checksum(bytes.subspan(2, 4 + length));
  if (bytes[total - 2] != expected.a || bytes[total - 1] != expected.b) {
    return Malformed{"UBX checksum", total - 2};
  }
  return {FrameView{{bytes[2], bytes[3]}, bytes.subspan(kHeaderBytes, length)}, total};
}

std::size_t find_sync(std::span<const std::uint8_t> bytes, std::size_t from) {
  for (std::size_t i = from; i < bytes.size(); ++i) {
    if (bytes[i] == kSync1 && (i + 1 == bytes.size() || bytes[i + 1] == kSync2)) {
      return i;
    }
  }
  return bytes.size();
}

void seal_frame(MessageId id, std::span<std::uint8_t> frame) {
  assert(frame.size() >= kOverheadBytes && frame.size() - kOverheadBytes <= 0xFFFF);
  frame[0] = kSync1;
  frame[1] = kSync2;
  frame[2] = id.message_class;
  frame[3] = id.message_id;
  store_little(frame, 4, static_cast<std::uint16_t>(frame.size() - kOverheadBytes));
  const Checksum sum = checksum(frame.subspan(2, frame.size() - 2 - kChecksumBytes));
  frame[frame.size() - 2] = sum.a;
  frame[frame.size() - 1] = sum.b;
}

std::size_t encode_frame(MessageId id, std::span<const std::uint8_t> payload,
                         std::span<std::uint8_t> out) {
  const std::size_t total = kOverheadBytes + payload.size();
  if (payload.size() > 0xFFFF || out.size() < total) {
    return 0;
  }
  std::ranges::copy(payload, out.begin() + kHeaderBytes);
  seal_frame(id, out.first(total));
  return total;
}

}  // namespace rigwire::protocols::ubx
