// One list of fields per UBX message, shared by encoder and decoder.
//
// A message is a plain struct in wire units with
//   static constexpr MessageId kId;  static constexpr std::size_t kLength;  (payload bytes)
//   static constexpr auto fields(auto& m)   std::tie of its members in the order of the payload
// A member is a number (integer, float, double: U, I, R4, R8), or a std::array of numbers
// (consecutive). gap<n> stands for n reserved bytes: written as zero, ignored on reading. Fields
// and gaps together have kLength bytes. Messages with a repeated part are two such structs, a head
// and a block.
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

template <std::size_t kBytes>
struct Gap {
  friend constexpr bool operator==(const Gap&, const Gap&) = default;
};
template <std::size_t kBytes>
inline constexpr Gap<kBytes> gap{};

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

template <std::size_t kBytes>
constexpr void store(std::span<std::uint8_t> bytes, std::size_t offset, const Gap<kBytes>&) {
  std::ranges::fill(bytes.subspan(offset, kBytes), std::uint8_t{0});
}
template <std::size_t kBytes>
constexpr void load(std::span<const std::uint8_t>, std::size_t, const Gap<kBytes>&) {}

template <class Field>
inline constexpr std::size_t kFieldBytes = sizeof(Field);
template <std::size_t kBytes>
inline constexpr std::size_t kFieldBytes<Gap<kBytes>> = kBytes;

/// Calls visit(offset, field) for each field and gap; returns the offset behind the last one.
template <class Fields, class Visit>
constexpr std::size_t for_each_field(const Fields& fields, [[maybe_unused]] const Visit& visit) {
  std::size_t offset = 0;
  std::apply(
      [&](auto&... field) {
        ((visit(offset, field), offset += kFieldBytes<std::remove_cvref_t<decltype(field)>>), ...);
      },
      fields);
  return offset;
}

}  // namespace detail

/// Messages are equal when all their fields are.
template <class Message>
requires requires(const Message& m) {
  Message::fields(m);
}
[[nodiscard]] constexpr bool operator==(const Message& left, const Message& right) {
  return Message::fields(left) == Message::fields(right);
}

/// True when fields and gaps have the length of the message; for static_assert.
template <class Message>
[[nodiscard]] constexpr bool layout_is_sound() {
  const Message message;
  return detail::for_each_field(Message::fields(message), [](std::size_t, auto&) {}) ==
         Message::kLength;
}

/// Writes the payload; exactly Message::kLength bytes. Precondition: the span has that size.
template <class Message>
constexpr void write_payload(const Message& message, std::span<std::uint8_t> payload) {
  static_assert(layout_is_sound<Message>());
  detail::for_each_field(Message::fields(message), [&](std::size_t offset, auto& field) {
    detail::store(payload, offset, field);
  });
}

/// Reads the fields of a payload of at least Message::kLength bytes (precondition).
template <class Message>
[[nodiscard]] constexpr Message read_payload(std::span<const std::uint8_t> payload) {
  Message message;
  detail::for_each_field(Message::fields(message), [&](std::size_t offset, auto& field) {
    detail::load(payload, offset, field);
  });
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

/// Encodes a frame into `out`, which has room for it (precondition); under another id if the
/// message has two. Returns the size of the frame.
template <class Message>
std::size_t encode(const Message& message, std::span<std::uint8_t> out,
                   MessageId id = Message::kId) {
  const auto frame = out.first(frame_size<Message>());
  write_payload(message, frame.subspan(kHeaderBytes, Message::kLength));
  seal_frame(id, frame);
  return frame.size();
}

}  // namespace rigwire::protocols::ubx
