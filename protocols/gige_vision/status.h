// How a GigE Vision device answers: the status of an acknowledge (GVCP) and of a stream packet
// (GVSP). Bit 15 set: an error.
//
// Sources: Aravis 0.8.26, src/arvgvcpprivate.h and src/arvgvspprivate.h; Wireshark 4.0,
// epan/dissectors/packet-gvcp.c. The standard's own text (AIA/A3, GigE Vision 2.x) is not public.
#pragma once

#include <cstdint>

namespace rigwire::protocols::gige_vision {

enum class Status : std::uint16_t {
  success = 0x0000,
  packet_resent = 0x0100,  ///< GVSP: a packet that is sent once more, and is good.
  not_implemented = 0x8001,
  invalid_parameter = 0x8002,
  invalid_address = 0x8003,
  write_protect = 0x8004,
  bad_alignment = 0x8005,
  access_denied = 0x8006,
  busy = 0x8007,
  packet_unavailable = 0x800C,
  data_overrun = 0x800D,
  invalid_header = 0x800E,
  /// The next three only to clients that have switched them on (kConfigurationExtendedStatus).
  packet_not_yet_available = 0x8010,
  packet_and_previous_removed = 0x8011,
  packet_removed = 0x8012,
  error = 0x8FFF,
};

[[nodiscard]] constexpr bool is_error(Status status) {
  return (static_cast<std::uint16_t>(status) & 0x8000U) != 0;
}

}  // namespace rigwire::protocols::gige_vision
