// What a message on a wire says, for people who look on: words for a line, and its fields with the
// bytes that they lie in, as far as the house's tables name them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocols/can/frame.h"
#include "protocols/can/message.h"

namespace rigwire::hil {

/// Of a message so many bytes are shown; fields that begin beyond them may be left out.
inline constexpr std::size_t kShownBytes = 128;

struct WireField {
  std::string name;
  std::string value;      ///< With its unit; empty: there is nothing to say of it.
  std::size_t from = 0;   ///< Byte of the message.
  std::size_t bytes = 0;  ///< That it takes or shares with others.
};

struct WireReading {
  std::string text;
  std::vector<WireField> fields;  ///< In the order of the bytes.
};

/// Of a serial line: NMEA (protocols/nmea/field_names.h); UBX with its frame, of NAV-PVT, NAV-SAT,
/// NAV-POSLLH, NAV-STATUS and of the acknowledgements the payload too; RTCM 3 with its frame, the
/// station, of 1005 and 1006 where it is, of observations the head. What begins in the middle of a
/// message has no fields.
[[nodiscard]] WireReading read_serial(std::span<const std::uint8_t> bytes);
/// Of a Velodyne lidar.
[[nodiscard]] WireReading read_datagram(std::span<const std::uint8_t> bytes);
/// Of a GigE Vision camera: of its stream (GVSP), and at its port of control (GVCP).
[[nodiscard]] WireReading read_stream_packet(std::span<const std::uint8_t> bytes);
[[nodiscard]] WireReading read_control_packet(std::span<const std::uint8_t> bytes);
/// Of a CAN bus whose messages these are. The bytes are those of the frame's data.
[[nodiscard]] WireReading read_frame(const protocols::can::Frame& frame,
                                     std::span<const protocols::can::OwnedMessage> messages);

/// The message of that frame; null: none, or it is a remote frame.
[[nodiscard]] const protocols::can::OwnedMessage* message_of(
    const protocols::can::Frame& frame, std::span<const protocols::can::OwnedMessage> messages);

}  // namespace rigwire::hil
