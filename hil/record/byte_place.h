// What a byte of a wire belongs to, in words: the message and, where the house's tables name it,
// the field. For people who look for why two streams differ.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "protocols/can/message.h"

namespace rigwire::hil {

/// Byte `at` of a stretch of a serial line: "UBX 0x01 0x07, byte 27", "$GNGGA, field 6". UBX, NMEA
/// and RTCM 3 are told apart; empty: the byte is in no message that begins in `bytes`.
[[nodiscard]] std::string serial_place(std::span<const std::uint8_t> bytes, std::size_t at);

/// Byte `at` of a datagram: of a Velodyne data packet its block, firing and laser's place, of a
/// position packet that it is one; else empty.
[[nodiscard]] std::string datagram_place(std::span<const std::uint8_t> bytes, std::size_t at);

/// Byte `at` of a packet of a CAN bus (protocols/pcapng/link_packet.h): identifier, message and
/// signal whose bits differ from those of `other`.
[[nodiscard]] std::string can_place(std::span<const std::uint8_t> packet,
                                    std::span<const std::uint8_t> other, std::size_t at,
                                    std::span<const protocols::can::OwnedMessage> messages);

}  // namespace rigwire::hil
