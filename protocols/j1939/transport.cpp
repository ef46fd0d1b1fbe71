#include "protocols/j1939/transport.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"
#include "protocols/j1939/message.h"

namespace rigwire::protocols::j1939 {
namespace {

constexpr std::size_t kFrameBytes = 8;
constexpr std::size_t kGroupAt = 5;
using FrameBytes = std::array<std::uint8_t, kFrameBytes>;

bool is_control(std::uint8_t value) {
  switch (static_cast<TransportControl>(value)) {
    case TransportControl::request_to_send:
    case TransportControl::clear_to_send:
    case TransportControl::end_of_message:
    case TransportControl::broadcast:
    case TransportControl::abort:
      return true;
  }
  return false;
}

}  // namespace

can::Frame make_transport_management(std::uint8_t source, std::uint8_t destination,
                                     const TransportManagement& management) {
  FrameBytes bytes;
  bytes.fill(0xFF);
  bytes[0] = static_cast<std::uint8_t>(management.control);
  switch (management.control) {
    case TransportControl::request_to_send:
      bytes[4] = management.limit;
      [[fallthrough]];
    case TransportControl::end_of_message:
    case TransportControl::broadcast:
      store_little<std::uint16_t>(bytes, 1, management.size);
      bytes[3] = management.packets;
      break;
    case TransportControl::clear_to_send:
      bytes[1] = management.packets;
      bytes[2] = management.next;
      break;
    case TransportControl::abort:
      bytes[1] = static_cast<std::uint8_t>(management.reason);
      break;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    bytes[kGroupAt + i] = static_cast<std::uint8_t>((management.pgn >> (8 * i)) & 0xFFU);
  }
  return make_frame({kTransportPriority, kTransportManagementPgn, destination, source}, bytes);
}

Decoded<TransportManagement> decode_transport_management(std::span<const std::uint8_t> payload) {
  if (payload.size() != kFrameBytes) {
    return Malformed{"transport management has exactly 8 bytes", payload.size()};
  }
  if (!is_control(payload[0])) {
    return Malformed{"control is 16, 17, 19, 32 or 255", 0};
  }
  TransportManagement management;
  management.control = static_cast<TransportControl>(payload[0]);
  switch (management.control) {
    case TransportControl::request_to_send:
      management.limit = payload[4];
      [[fallthrough]];
    case TransportControl::end_of_message:
    case TransportControl::broadcast:
      management.size = load_little<std::uint16_t>(payload, 1);
      management.packets = payload[3];
      break;
    case TransportControl::clear_to_send:
      management.packets = payload[1];
      management.next = payload[2];
      break;
    case TransportControl::abort:
      management.reason = static_cast<AbortReason>(payload[1]);
      break;
  }
  management.pgn = payload[kGroupAt] | (static_cast<std::uint32_t>(payload[kGroupAt + 1]) << 8U) |
                   (static_cast<std::uint32_t>(payload[kGroupAt + 2] & 0x3U) << 16U);
  return {management, kFrameBytes};
}

can::Frame make_transport_data(std::uint8_t source, std::uint8_t destination,
                               std::span<const std::uint8_t> message, std::uint8_t number) {
  assert(number >= 1 && number <= packets_of(message.size()));
  FrameBytes bytes;
  bytes.fill(0xFF);
  bytes[0] = number;
  const auto packet = message.subspan((number - 1U) * kPacketBytes);
  std::ranges::copy(packet.first(std::min(packet.size(), kPacketBytes)), bytes.begin() + 1);
  return make_frame({kTransportPriority, kTransportDataPgn, destination, source}, bytes);
}

Decoded<TransportData> decode_transport_data(std::span<const std::uint8_t> payload) {
  if (payload.size() != kFrameBytes) {
    return Malformed{"transport data has exactly 8 bytes", payload.size()};
  }
  TransportData data;
  data.number = payload[0];
  std::ranges::copy(payload.subspan(1), data.bytes.begin());
  return {data, kFrameBytes};
}

}  // namespace rigwire::protocols::j1939
