// The error frames of SocketCAN: how a controller's report reaches programs on Linux.
//
// Source: Linux, include/uapi/linux/can/error.h. An error frame is a frame with flag 0x20000000 in
// its identifier, error classes in the other identifier bits and details in its eight bytes:
//
//   class      meaning              details
//   0x00000002 arbitration lost     d0 number of the bit, 0 = not known
//   0x00000004 controller           d1 0x01/02 receive/transmit overflow, 0x04/08 receive/transmit
//                                      counter at the warning level, 0x10/20 passive, 0x40 active
//   0x00000008 protocol             d2 0x01 bit, 0x02 form, 0x04 stuff, 0x08 dominant bit not sent,
//                                      0x10 recessive bit not sent, 0x80 own frame; d3 field
//   0x00000020 no acknowledgement
//   0x00000040 bus-off
//   0x00000080 error on the bus
//   0x00000100 restarted after bus-off
//   0x00000200 counters             d6 transmit, d7 receive
//
// A CRC error has no type in d2: d3 is the CRC sequence (0x08), as the kernel's drivers do it.
// Classes 0x01 (transmit time-out) and 0x10 (transceiver) belong to no report of this project.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/can/controller_report.h"
#include "protocols/result.h"

namespace rigwire::protocols::can {

inline constexpr std::uint32_t kErrorFlag = 0x2000'0000U;

struct ErrorFrame {
  std::uint32_t id = 0;  ///< kErrorFlag and classes, as in struct can_frame.
  std::array<std::uint8_t, 8> data{};

  friend bool operator==(const ErrorFrame&, const ErrorFrame&) = default;
};

/// Not carried: `bit`, except where arbitration was lost; a state that did not change; counters
/// with the news of bus-off. An acknowledgement error is always in an own frame and in the
/// acknowledge slot, a CRC error in the CRC sequence. Counters beyond 255 are cut to 255.
[[nodiscard]] ErrorFrame to_error_frame(const ControllerReport& report);

/// The state is the one that the frame names; where it names none, that of the counters, and
/// without counters ErrorState::active. What it says of more than one error (bit and form at once)
/// is the first of bit, stuff, form, crc, acknowledgement. Malformed: without kErrorFlag, or with
/// the flag of 29-bit or remote frames.
[[nodiscard]] Decoded<ControllerReport> from_error_frame(const ErrorFrame& frame);

}  // namespace rigwire::protocols::can
