// How long a classic CAN frame is on the wire, and who wins arbitration.
//
// Source: ISO 11898-1:2015, 10.4 (frame formats), 10.5 (bit stuffing), 10.4.2.6 (CRC). A frame is
//   SOF 1 + arbitration + control + data + CRC 15      (stuffed: after five equal bits one inverse)
//   CRC delimiter 1 + ACK 2 + EOF 7                    (not stuffed)
//   interframe space 3                                 (the bus is not free before its end)
// Lengths here are exact: the bits are built, the CRC computed, the stuff bits counted. CAN FD is
// not modelled. A frame with id or length out of range is taken modulo its field width.
#pragma once

#include <cstdint>

#include "protocols/can/frame.h"

namespace rigwire::protocols::can {

/// CRC delimiter, ACK slot, ACK delimiter, seven bits end of frame.
inline constexpr unsigned kTrailerBits = 1 + 1 + 1 + 7;
/// Interframe space (intermission) after each frame.
inline constexpr unsigned kInterframeBits = 3;
/// 11-bit frame without data: SOF, identifier, RTR, IDE, r0, DLC, CRC, trailer, interframe.
inline constexpr unsigned kBaseOverheadBits =
    1 + 11 + 1 + 1 + 1 + 4 + 15 + kTrailerBits + kInterframeBits;
static_assert(kBaseOverheadBits == 47);
/// 29-bit frame without data: SRR, 18 more identifier bits and r1 on top.
inline constexpr unsigned kExtendedOverheadBits = kBaseOverheadBits + 1 + 18 + 1;
static_assert(kExtendedOverheadBits == 67);

/// Bits from start of frame to the end of the interframe space, without stuff bits.
[[nodiscard]] unsigned unstuffed_bits(const Frame& frame);

/// The CRC sequence, 15 bits.
[[nodiscard]] std::uint16_t checksum(const Frame& frame);

/// Bits from start of frame to the end of the interframe space, as they are sent. By tables, a byte
/// at a time: some 30 ns.
[[nodiscard]] unsigned exact_bits(const Frame& frame);

/// The most that any frame of this format and length can have.
[[nodiscard]] unsigned worst_case_bits(const Frame& frame);

/// The arbitration field as a number, first bit on the wire highest: base identifier 11, RTR (SRR =
/// 1 in a 29-bit frame), IDE, 18 extension bits, RTR. Dominant is 0, so the smaller value wins.
/// Equal values mean that two nodes use one identifier, which ends in a bit error on a real bus.
[[nodiscard]] std::uint32_t arbitration_field(const Frame& frame);

}  // namespace rigwire::protocols::can
