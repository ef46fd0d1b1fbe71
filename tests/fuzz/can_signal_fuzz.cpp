// Any row with any payload is harmless, and what a sound row reads is sent as it was.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/bytes.h"
#include "protocols/can/signal.h"

namespace can = rigwire::protocols::can;
using rigwire::protocols::load_little;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRow = 2 + 1 + 1 + 8 + 8 + 8 + 8;  // bit, width, flags, four numbers
  constexpr std::size_t kLongest = 64;
  if (size < kRow) {
    return 0;
  }
  const std::span<const std::uint8_t> input(data, size);
  const auto number = [&](std::size_t at) {
    return std::bit_cast<double>(load_little<std::uint64_t>(input, at));
  };
  can::Coding row;
  row.bit = load_little<std::uint16_t>(input, 0);
  row.width = data[2];
  row.order = (data[3] & 1U) != 0 ? can::ByteOrder::big_endian : can::ByteOrder::little_endian;
  row.is_signed = (data[3] & 2U) != 0;
  row.is_float = (data[3] & 4U) != 0;
  row.reserved = (data[3] & 8U) != 0 ? can::Reserved::j1939 : can::Reserved::none;
  row.scale = number(4);
  row.offset = number(12);
  row.lower = number(20);
  row.upper = number(28);
  std::array<std::uint8_t, kLongest> buffer{};
  const std::size_t length = std::min(size - kRow, buffer.size());
  std::copy_n(data + kRow, length, buffer.begin());
  const auto payload = std::span(buffer).first(length);

  const can::Reading reading = can::get(row, payload);
  require(!reading.valid() || can::fits(row, length));
  const auto before = buffer;
  can::put(row, payload, reading.number());
  for (std::size_t i = 0; i < buffer.size(); ++i) {
    require(((buffer[i] ^ before[i]) & ~can::bits_in(row, i)) == 0);
  }
  // Over all that it carries, a plain integer of up to 53 bits returns exactly.
  row.scale = 1.0;
  row.offset = 0.0;
  row = can::unlimited(row);
  if (can::defect(row, length).empty() && !row.is_float && row.width <= 53) {
    buffer = before;
    const can::Reading plain = can::get(row, payload);
    can::put(row, payload, plain.number());
    require(!plain.valid() || buffer == before);
  }
  return 0;
}
