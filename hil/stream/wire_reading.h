// Decodes a message on a wire for viewers: words for a line, and its fields with the bytes that
// they occupy, as far as the project's tables name them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocols/can/frame.h"
#include "protocols/can/message.h"

namespace rigwire::hil {

/// Bytes of a message that are shown; fields that begin beyond them may be left out.
inline constexpr std::size_t kShownBytes = 128;

struct WireField {
  std::string name;
  std::string value;      ///< Value with its unit; may be empty.
  std::size_t from = 0;   ///< Offset of its first byte in the message.
  std::size_t bytes = 0;  ///< Bytes that it occupies or shares with others.
};

struct WireReading {
  std::string text;
  std::vector<WireField> fields;  ///< In the order of the bytes.
};

/// Reads a message of a serial line: NMEA (protocols/nmea/field_names.h); UBX with its frame, for
/// NAV-PVT, NAV-SAT, NAV-POSLLH, NAV-STATUS and the acknowledgements also the payload; RTCM 3 with
/// its frame and station, for 1005 and 1006 the station's position, for observations the header.
/// Bytes that begin in the middle of a message have no fields.
[[nodiscard]] WireReading read_serial(std::span<const std::uint8_t> bytes);
/// Reads a datagram of a Velodyne lidar.
[[nodiscard]] WireReading read_datagram(std::span<const std::uint8_t> bytes);
/// Read datagrams of a GigE Vision camera: of its stream (GVSP), and at its control port (GVCP).
[[nodiscard]] WireReading read_stream_packet(std::span<const std::uint8_t> bytes);
[[nodiscard]] WireReading read_control_packet(std::span<const std::uint8_t> bytes);
/// Reads a frame of a CAN bus that has these messages. Bytes are counted in the frame's data.
[[nodiscard]] WireReading read_frame(const protocols::can::Frame& frame,
                                     std::span<const protocols::can::OwnedMessage> messages);

/// Returns the message of that frame; null: none, or it is a remote frame.
[[nodiscard]] const protocols::can::OwnedMessage* message_of(
    const protocols::can::Frame& frame, std::span<const protocols::can::OwnedMessage> messages);

}  // namespace rigwire::hil
