// Bytes to integers and back, one place for both byte orders. Every reader checks nothing: callers
// check the length of the span first (the layouts are fixed), asserts catch a programmer's slip.
#pragma once

#include <bit>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace rigwire::protocols {

/// The unsigned or signed integer of sizeof(Integer) bytes at `offset`, least significant byte
/// first.
template <std::integral Integer>
[[nodiscard]] constexpr Integer load_little(std::span<const std::uint8_t> bytes,
                                            std::size_t offset) {
  assert(offset + sizeof(Integer) <= bytes.size());
  using Unsigned = std::make_unsigned_t<Integer>;
  Unsigned value = 0;
  for (std::size_t i = sizeof(Integer); i-- > 0;) {
    value = static_cast<Unsigned>((static_cast<std::uint64_t>(value) << 8U) | bytes[offset + i]);
  }
  return std::bit_cast<Integer>(value);
}

/// Most significant byte first.
template <std::integral Integer>
[[nodiscard]] constexpr Integer load_big(std::span<const std::uint8_t> bytes, std::size_t offset) {
  assert(offset + sizeof(Integer) <= bytes.size());
  using Unsigned = std::make_unsigned_t<Integer>;
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    value = static_cast<Unsigned>((static_cast<std::uint64_t>(value) << 8U) | bytes[offset + i]);
  }
  return std::bit_cast<Integer>(value);
}

template <std::integral Integer>
constexpr void store_little(std::span<std::uint8_t> bytes, std::size_t offset, Integer value) {
  assert(offset + sizeof(Integer) <= bytes.size());
  auto rest = static_cast<std::uint64_t>(std::bit_cast<std::make_unsigned_t<Integer>>(value));
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    bytes[offset + i] = static_cast<std::uint8_t>(rest & 0xFFU);
    rest >>= 8U;
  }
}

template <std::integral Integer>
constexpr void store_big(std::span<std::uint8_t> bytes, std::size_t offset, Integer value) {
  assert(offset + sizeof(Integer) <= bytes.size());
  auto rest = static_cast<std::uint64_t>(std::bit_cast<std::make_unsigned_t<Integer>>(value));
  for (std::size_t i = sizeof(Integer); i-- > 0;) {
    bytes[offset + i] = static_cast<std::uint8_t>(rest & 0xFFU);
    rest >>= 8U;
  }
}

}  // namespace rigwire::protocols
