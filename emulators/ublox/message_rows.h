// How one row of UbloxProfile::messages is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "emulators/ublox/profile.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/monitor.h"

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
/// The same without a rate in CFG-MSG: it comes as an answer only.
[[nodiscard]] constexpr UbloxMessage on_demand(UbloxMessage message) {
  message.periodic = false;
  return message;
}
/// The same without an answer to a poll: it comes by its rate or with its event only.
[[nodiscard]] constexpr UbloxMessage unasked(UbloxMessage message) {
  message.polled = false;
  return message;
}
[[nodiscard]] constexpr UbloxMessage version_row() {
  return listed(protocols::ubx::MonVerHead::kId, "MON-VER",
                protocols::ubx::MonVerHead::kLength +
                    7 /*extensions*/ * protocols::ubx::MonVerExtension::kLength);
}
/// CFG-MSG takes a rate, and nothing ever comes: what they would tell is not emulated.
[[nodiscard]] constexpr UbloxMessage silent(std::uint8_t message_class, std::uint8_t id) {
  return {{message_class, id}, {}, 0, message_class >= 0xF0, true, false};
}

}  // namespace rigwire::emulators
