// How one row of UbloxProfile::messages is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "emulators/ublox/profile.h"
#include "protocols/ubx/layout.h"

namespace rigwire::emulators {

/// Of fixed length.
template <class Message>
[[nodiscard]] constexpr UbloxMessage produced(std::string_view name, std::size_t repeated = 0) {
  return {Message::kId, name, protocols::ubx::frame_size<Message>() + repeated, false};
}
/// With a payload of varying length.
[[nodiscard]] constexpr UbloxMessage listed(protocols::ubx::MessageId id, std::string_view name,
                                            std::size_t payload) {
  return {id, name, protocols::ubx::kOverheadBytes + payload, false};
}
/// A head and so many blocks.
template <class Head, class Block>
[[nodiscard]] constexpr UbloxMessage listed(std::string_view name, std::size_t blocks) {
  return listed(Head::kId, name, Head::kLength + blocks * Block::kLength);
}
[[nodiscard]] constexpr UbloxMessage sentence(std::uint8_t id, std::string_view name,
                                              std::size_t bytes) {
  return {{0xF0, id}, name, bytes, true};
}
[[nodiscard]] constexpr UbloxMessage proprietary(std::uint8_t id, std::string_view name,
                                                 std::size_t bytes) {
  return {{0xF1, id}, name, bytes, true};
}
/// CFG-MSG takes a rate, and nothing ever comes: what they would tell is not emulated.
[[nodiscard]] constexpr UbloxMessage silent(std::uint8_t message_class, std::uint8_t id) {
  return {{message_class, id}, {}, 0, message_class >= 0xF0};
}

}  // namespace rigwire::emulators
