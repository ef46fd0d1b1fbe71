// One field table per UBX message, shared by encoder and decoder.
//
// A message is a plain struct in wire units with
//   static constexpr MessageId kId;  static constexpr std::size_t kLength;  (payload bytes)
//   static constexpr auto fields()   a tuple of at(offset, &Message::member)
// A member is an integer, or a std::array of integers (consecutive). Bytes that no field covers are
// reserved: written as zero, ignored on reading. Messages with a repeated part are two such
// structs, a head and a block.
#pragma once

#include <algorithm>
#include <array>
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

template <std::integral Integer>
constexpr void store(std::span<std::uint8_t> bytes, std::size_t offset, Integer value) {
  store_little(bytes, offset, value);
}
template <std::integral Integer, std::size_t kCount>
constexpr void store(std::span<std::uint8_t> bytes, std::size_t offset,
                     const std::array<Integer, kCount>& values) {
  for (std::size_t i = 0; i < kCount; ++i) {
    store_little(bytes, offset + i * sizeof(Integer), values[i]);
  }
}
template <std::integral Integer>
constexpr void load(std::span<const std::uint8_t> bytes, std::size_t offset, Integer& value) {
  value = load_little<Integer>(bytes, offset);
}
template <std::integral Integer, std::size_t kCount>
constexpr void load(std::span<const std::uint8_t> bytes, std::size_t offset,
                    std::array<Integer, kCount>& values) {
  for (std::size_t i = 0; i < kCount; ++i) {
    values[i] = load_little<Integer>(bytes, offset + i * sizeof(Integer));
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
constexpr void write_payload(const Message& message, std::span<std::uint8_t> payload) {
  static_assert(layout_is_sound<Message>());
  std::ranges::fill(payload, std::uint8_t{0});
  std::apply(
      [&](auto... field) { (detail::store(payload, field.offset, message.*field.member), ...); },
      Message::fields());
}

/// Reads the fields of a payload of at least Message::kLength bytes (precondition).
template <class Message>
[[nodiscard]] constexpr Message read_payload(std::span<const std::uint8_t> payload) {
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
