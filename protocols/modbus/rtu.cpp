#include "protocols/modbus/rtu.h"

#include <algorithm>

#include "protocols/bytes.h"

namespace rigwire::protocols::modbus {
namespace {

constexpr std::uint16_t kReflectedPolynomial = 0xA001;
constexpr std::uint32_t kFixedSilencesAbove_bps = 19'200;

constexpr auto kTable = [] {
  std::array<std::uint16_t, 256> table{};
  for (std::uint16_t byte = 0; byte < 256; ++byte) {
    unsigned crc = byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
    }
    table[byte] = static_cast<std::uint16_t>(crc);
  }
  return table;
}();

}  // namespace

std::uint16_t crc16(std::uint16_t before, std::uint8_t byte) {
  return static_cast<std::uint16_t>(before >> 8U ^ kTable[(before ^ byte) & 0xFFU]);
}

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = kCrcStart;
  for (const std::uint8_t byte : bytes) {
    crc = crc16(crc, byte);
  }
  return crc;
}

Decoded<RtuFrame> decode_rtu(std::span<const std::uint8_t> frame) {
  if (frame.size() < kRtuFrameMinimum) {
    return Malformed{"RTU frame shorter than 4 bytes", frame.size()};
  }
  if (frame.size() > kRtuFrameMaximum) {
    return Malformed{"RTU frame longer than 256 bytes", kRtuFrameMaximum};
  }
  if (crc16(frame) != 0) {
    return Malformed{"RTU check is wrong", frame.size() - kRtuCheckSize};
  }
  const auto pdu = frame.subspan(kRtuAddressSize, frame.size() - kRtuAddressSize - kRtuCheckSize);
  return {RtuFrame{frame[0], pdu}, frame.size()};
}

RtuBytes encode_rtu(std::uint8_t address, std::span<const std::uint8_t> pdu) {
  assert(!pdu.empty() && pdu.size() <= kPduMaximum);
  RtuBytes frame;
  frame.bytes[0] = address;
  std::ranges::copy(pdu, frame.bytes.begin() + kRtuAddressSize);
  const std::size_t checked = kRtuAddressSize + pdu.size();
  store_little(std::span(frame.bytes), checked, crc16(std::span(frame.bytes).first(checked)));
  frame.size = checked + kRtuCheckSize;
  return frame;
}

std::chrono::nanoseconds RtuTiming::characters(std::uint64_t count) const {
  const std::uint64_t bits = count * bits_of(character);
  return std::chrono::seconds(bits / baud) +
         std::chrono::nanoseconds(bits % baud * 1'000'000'000U / baud);
}

std::chrono::nanoseconds RtuTiming::inside_limit() const {
  return baud > kFixedSilencesAbove_bps ? std::chrono::microseconds(750) : characters(3) / 2;
}

std::chrono::nanoseconds RtuTiming::frame_silence() const {
  return baud > kFixedSilencesAbove_bps ? std::chrono::microseconds(1750) : characters(7) / 2;
}

}  // namespace rigwire::protocols::modbus
