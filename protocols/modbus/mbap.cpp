#include "protocols/modbus/mbap.h"

#include <algorithm>

#include "protocols/bytes.h"

namespace rigwire::protocols::modbus {
namespace {

constexpr std::size_t kTransaction = 0;
constexpr std::size_t kProtocol = kTransaction + 2;
constexpr std::size_t kLength = kProtocol + 2;
constexpr std::size_t kUnit = kLength + 2;
static_assert(kUnit + 1 == kMbapHeaderSize);

}  // namespace

Decoded<Adu> decode_adu(std::span<const std::uint8_t> stream) {
  if (stream.size() < kUnit) {
    return Incomplete{kMbapHeaderSize + 1, stream.size()};
  }
  const std::size_t length = load_big<std::uint16_t>(stream, kLength);
  if (length < kMbapLengthMinimum || length > kMbapLengthMaximum) {
    return Malformed{"MBAP length outside 2..254", kLength};
  }
  const std::size_t size = kUnit + length;
  if (stream.size() < size) {
    return Incomplete{size, stream.size()};
  }
  const MbapHeader header{load_big<std::uint16_t>(stream, kTransaction),
                          load_big<std::uint16_t>(stream, kProtocol), stream[kUnit]};
  return {Adu{header, stream.subspan(kMbapHeaderSize, size - kMbapHeaderSize)}, size};
}

AduBytes encode_adu(const MbapHeader& header, std::span<const std::uint8_t> pdu) {
  assert(!pdu.empty() && pdu.size() <= kPduMaximum);
  AduBytes adu;
  store_big(std::span(adu.bytes), kTransaction, header.transaction);
  store_big(std::span(adu.bytes), kProtocol, header.protocol);
  store_big(std::span(adu.bytes), kLength, static_cast<std::uint16_t>(1 + pdu.size()));
  adu.bytes[kUnit] = header.unit;
  std::ranges::copy(pdu, adu.bytes.begin() + kMbapHeaderSize);
  adu.size = kMbapHeaderSize + pdu.size();
  return adu;
}

}  // namespace rigwire::protocols::modbus
