// One field table per UBX message, shared by encoder and decoder.
//
// A message is a plain struct in wire units with
//   static constexpr MessageId kId;  static constexpr std::size_t kLength;  (payload bytes)
//   static constexpr auto fields()   a tuple of at(offset, &Message::member)
// A member is a number (integer, float, double: U, I, R4, R8), or a std::array of numbers
// (consecutive). Bytes that no field covers are
// reserved: written as zero, ignored on reading. Messages with a repeated part are two such
// structs, a head and a block.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>

#include "protocols/bytes.h"
#include "protocols/result.h"
#include "protocols/ubx/frame.h"

namespace rigwire::protocols::ubx {

template <class Message, class Value>
struct Field {
  std::size_t offset = 0;
  Value Message::*member = nullptr;
};

template <class Message, class Value>
[[nodiscard]] constexpr Field<Message, Value> at(std::size_t offset, Value Message::*member) {
  return {offset, member};
}

namespace detail {

template <class Value>
concept Number = std::integral<Value> || std::same_as<Value, float> || std::same_as<Value, double>;

/// The unsigned integer with the bits of an IEEE 754 number.
template <class Real>
using Bits =
    std::conditional_t<sizeof(Real) == sizeof(std::uint32_t), std::uint32_t, std::uint64_t>;

template <Number Value>
constexpr void store(std::span<std::uint8_t> bytes, std::size_t offset, Value value) {
  if constexpr (std::integral<Value>) {
    store_little(bytes, offset, value);
  } else {
    store_little(bytes, offset, std::bit_cast<Bits<Value>>(value));
  }
}
template <Number Value, std::size_t kCount>
constexpr void store(std::span<std::uint8_t> bytes, std::size_t offset,
                     const std::array<Value, kCount>& values) {
  for (std::size_t i = 0; i < kCount; ++i) {
    store(bytes, offset + i * sizeof(Value), values[i]);
  }
}
template <Number Value>
constexpr void load(std::span<const std::uint8_t> bytes, std::size_t offset, Value& value) {
  if constexpr (std::integral<Value>) {
    value = load_little<Value>(bytes, offset);
  } else {
    value = std::bit_cast<Value>(load_little<Bits<Value>>(bytes, offset));
  }
}
template <Number Value, std::size_t kCount>
constexpr void load(std::span<const std::uint8_t> bytes, std::size_t offset,
                    std::array<Value, kCount>& values) {
  for (std::size_t i = 0; i < kCount; ++i) {
    load(bytes, offset + i * sizeof(Value), values[i]);
  }
}

}  // namespace detail

/// True when every field lies within the message and no two overlap; for static_assert.
template <class Message>
[[nodiscard]] constexpr bool layout_is_sound() {
  std::array<int, Message::kLength> uses{};
  bool inside = true;
  const auto mark = [&](auto field) {
    using Value = std::remove_cvref_t<decltype(std::declval<Message>().*field.member)>;
    for (std::size_t i = field.offset; i < field.offset + sizeof(Value); ++i) {
      if (i < uses.size()) {
        ++uses[i];
      } else {
        inside = false;
      }
    }
  };
  std::apply([&](auto... field) { (mark(field), ...); }, Message::fields());
  return inside && std::ranges::all_of(uses, [](int n) { return n <= 1; });
}

/// Writes the payload; exactly Message::kLength bytes. Precondition: the span has that size.
template <class Message>
constexpr void write_payload([[maybe_unused]] const Message& message,
                             std::span<std::uint8_t> payload) {
  static_assert(layout_is_sound<Message>());
  std::ranges::fill(payload, std::uint8_t{0});
  std::apply(
      [&](auto... field) { (detail::store(payload, field.offset, message.*field.member), ...); },
      Message::fields());
}

/// Reads the fields of a payload of at least Message::kLength bytes (precondition).
template <class Message>
[[nodiscard]] constexpr Message read_payload(
    [[maybe_unused]] std::span<const std::uint8_t> payload) {
  Message message;
  std::apply(
      [&](auto... field) { (detail::load(payload, field.offset, message.*field.member), ...); },
      Message::fields());
  return message;
}

/// The message in a frame: malformed when class, id or length are another message's.
template <class Message>
[[nodiscard]] Decoded<Message> decode(const FrameView& frame) {
  if (frame.id != Message::kId) {
    return Malformed{"another UBX message", 2};
  }
  if (frame.payload.size() != Message::kLength) {
    return Malformed{"UBX payload length", 4};
  }
  return {read_payload<Message>(frame.payload), kOverheadBytes + Message::kLength};
}

/// The whole frame of a message of fixed length.
template <class Message>
[[nodiscard]] constexpr std::size_t frame_size() {
  return kOverheadBytes + Message::kLength;
}
template <class Message>
[[nodiscard]] std::array<std::uint8_t, frame_size<Message>()> encode(const Message& message) {
  std::array<std::uint8_t, frame_size<Message>()> frame{};
  write_payload(message, std::span(frame).subspan(kHeaderBytes, Message::kLength));
  seal_frame(Message::kId, frame);
  return frame;
}

}  // namespace rigwire::protocols::ubx
