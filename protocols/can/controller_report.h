// What a CAN controller reports to its host besides frames: errors that it saw, and its state.
//
// Source: ISO 11898-1:2015, 10.4.4 and 10.11 (error signalling), 12.1.4 (fault confinement).
#pragma once

#include <cstdint>

namespace rigwire::protocols::can {

/// Fault confinement, from the greater of the two error counters. `warning` is no state of the
/// standard, but every controller announces it.
enum class ErrorState : std::uint8_t {
  active,   ///< Below 96.
  warning,  ///< 96 .. 127.
  passive,  ///< 128 .. 255: error flags are recessive.
  bus_off,  ///< The transmit counter went beyond 255: takes no part until it has recovered.
};

/// The five errors that a controller detects.
enum class BusError : std::uint8_t { none, bit, stuff, form, crc, acknowledgement };

/// Field of a frame; `unspecified` also for everything after it.
enum class FrameField : std::uint8_t {
  unspecified,
  start_of_frame,
  identifier_28_21,   ///< In an 11-bit frame bits 10 .. 3.
  identifier_20_18,   ///< In an 11-bit frame bits 2 .. 0.
  substitute_remote,  ///< SRR; in an 11-bit frame RTR.
  identifier_extension,
  identifier_17_13,
  identifier_12_5,
  identifier_4_0,
  remote_request,  ///< RTR of a 29-bit frame.
  reserved_1,
  reserved_0,
  length_code,
  data,
  crc_sequence,
  crc_delimiter,
  acknowledge_slot,
  acknowledge_delimiter,
  end_of_frame,
  intermission,
};

struct ControllerReport {
  ErrorState state = ErrorState::active;
  std::uint16_t transmit_errors = 0;  ///< Counter, 0 .. 256; 256 stands for every value beyond 255.
  std::uint16_t receive_errors = 0;   ///< Counter, 0 .. 255.
  bool state_changed = false;         ///< This report is (also) about `state`.
  BusError error = BusError::none;    ///< This report is (also) about an error on the bus.
  bool transmitting = false;          ///< The error concerned this controller's own frame.
  bool dominant = false;              ///< BusError::bit: the bit that was sent was dominant.
  std::uint8_t bit = 0;               ///< Bit of the frame; start of frame is 0, stuff bits count.
  FrameField field = FrameField::unspecified;  ///< Field of `bit`.
  bool restarted = false;                      ///< Back from bus-off.
  bool arbitration_lost = false;   ///< Only one-shot controllers report it; `bit` says where.
  bool receive_overflow = false;   ///< A frame that the host did not fetch in time is lost.
  bool transmit_overflow = false;  ///< A frame did not fit into the transmit queue.

  friend bool operator==(const ControllerReport&, const ControllerReport&) = default;
};

}  // namespace rigwire::protocols::can
