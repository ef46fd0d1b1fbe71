// Messages of 9 to 1785 bytes: the frames of the transport protocol.
//
// Source: SAE J1939-21, 5.10. A message is announced by connection management (PGN 60416), cut into
// packets of seven bytes and sent by data transfer (PGN 60160), each packet with its number from 1
// on; the last one is filled with ones. To everybody: announced (BAM) and sent at a pace. To one
// node: asked (request to send), granted in portions (clear to send), acknowledged (end of
// message); either side may abort. Sessions and timers: emulators/j1939/j1939_transport.h.
//
// Management frame, bytes from 1:
//   request to send 16    2-3 size, 4 packets, 5 max packets in one portion, 6-8 group
//   clear to send 17      2 packets of the portion (0: hold), 3 number of the first, 6-8 group
//   end of message 19     2-3 size, 4 packets, 6-8 group
//   broadcast 32          2-3 size, 4 packets, 6-8 group
//   abort 255             2 reason, 6-8 group
// Numbers have their low byte first; what has no meaning is sent as ones.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::j1939 {

inline constexpr std::uint32_t kTransportManagementPgn = 60416;  ///< EC00, addressed, 8 bytes.
inline constexpr std::uint32_t kTransportDataPgn = 60160;        ///< EB00, addressed, 8 bytes.
inline constexpr std::uint8_t kTransportPriority = 7;

/// Data bytes of a frame, after the packet's number.
inline constexpr std::size_t kPacketBytes = 8 - 1;
inline constexpr std::size_t kLeastTransported = 9;
inline constexpr std::size_t kGreatestTransported = 255 * kPacketBytes;
static_assert(kGreatestTransported == 1785);

/// Packets of a message of `size` bytes.
[[nodiscard]] constexpr std::uint8_t packets_of(std::size_t size) {
  return static_cast<std::uint8_t>((size + kPacketBytes - 1) / kPacketBytes);
}

enum class TransportControl : std::uint8_t {
  request_to_send = 16,
  clear_to_send = 17,
  end_of_message = 19,
  broadcast = 32,
  abort = 255,
};

/// Why a session ends early.
enum class AbortReason : std::uint8_t {
  busy = 1,          ///< Already in a session, and cannot support another one.
  no_resources = 2,  ///< Needed for another task.
  timeout = 3,
  clear_while_sending = 4,   ///< Clear to send before the last portion was sent.
  too_many_repetitions = 5,  ///< A portion was repeated too often.
  unexpected_packet = 6,     ///< Data although none was granted.
  bad_sequence = 7,          ///< A sequence number that is not possible.
  /// Not sent by this project: a packet that was received already is ignored.
  duplicate_sequence = 8,
  too_long = 9,  ///< More than 1785 bytes.
  other = 250,
};

/// One management frame; members that its control does not use are ignored.
struct TransportManagement {
  TransportControl control = TransportControl::abort;
  std::uint16_t size = 0;  ///< Size of the message, bytes.
  /// Packets of the message; clear to send: of the portion, 0 is "hold".
  std::uint8_t packets = 0;
  std::uint8_t limit = 0xFF;  ///< Request to send: max packets in one portion.
  std::uint8_t next = 0;      ///< Clear to send: number of the portion's first packet.
  AbortReason reason = AbortReason::other;
  std::uint32_t pgn = 0;  ///< Group of the message.

  friend bool operator==(const TransportManagement&, const TransportManagement&) = default;
};

[[nodiscard]] can::Frame make_transport_management(std::uint8_t source, std::uint8_t destination,
                                                   const TransportManagement& management);
/// Malformed unless the payload has eight bytes and one of the controls above. Sizes and numbers
/// are as the sender says: see announces_message.
[[nodiscard]] Decoded<TransportManagement> decode_transport_management(
    std::span<const std::uint8_t> payload);
/// Whether size and packets are those of a message that the protocol can carry.
[[nodiscard]] constexpr bool announces_message(const TransportManagement& management) {
  return management.size >= kLeastTransported && management.size <= kGreatestTransported &&
         management.packets == packets_of(management.size);
}

/// Packet `number`, from 1 on, of a message. Precondition: the message has such a packet.
[[nodiscard]] can::Frame make_transport_data(std::uint8_t source, std::uint8_t destination,
                                             std::span<const std::uint8_t> message,
                                             std::uint8_t number);

struct TransportData {
  std::uint8_t number = 0;
  std::array<std::uint8_t, kPacketBytes> bytes{};
};
/// Malformed unless the payload has eight bytes.
[[nodiscard]] Decoded<TransportData> decode_transport_data(std::span<const std::uint8_t> payload);

}  // namespace rigwire::protocols::j1939
