// Names what a byte of a wire belongs to: the message and, where the project's tables name it, the
// field. For users who search for why two streams differ.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "protocols/can/message.h"

namespace rigwire::hil {

/// Returns the place of byte `at` in a piece of a serial line: "UBX 0x01 0x07, byte 27", "$GNGGA,
/// field 6". Recognizes UBX, NMEA and RTCM 3; empty: the byte is in no message that begins in
/// `bytes`.
[[nodiscard]] std::string serial_place(std::span<const std::uint8_t> bytes, std::size_t at);

/// Returns the place of byte `at` in a datagram: for a Velodyne data packet the block, firing and
/// laser's place, for a position packet that it is one; else empty.
[[nodiscard]] std::string datagram_place(std::span<const std::uint8_t> bytes, std::size_t at);

/// Returns the place of byte `at` in a packet of a CAN bus (protocols/pcapng/link_packet.h):
/// identifier, message and signal whose bits differ from those of `other`.
[[nodiscard]] std::string can_place(std::span<const std::uint8_t> packet,
                                    std::span<const std::uint8_t> other, std::size_t at,
                                    std::span<const protocols::can::OwnedMessage> messages);

}  // namespace rigwire::hil
