// CAN frames as lines of ASCII on a serial line: the LAWICEL CANUSB protocol in the dialects of the
// Linux kernel's slcan driver and of python-can.
//
// Sources: LAWICEL AB, "CANUSB manual" 1.0D (commands and replies); Linux 6.1,
// drivers/net/can/slcan (what the kernel sends and reads).
//
//   host to adapter                          adapter to host
//   O L C       open, listen only, close     CR        done
//   S0..S9      bit rate (bit_rate.h)        BEL       refused
//   sxxyy       bit-timing registers         z CR, Z CR  frame taken (auto-poll)
//   tiiildd..   11-bit data frame            tiiildd.. received frame [+ 4 digits of time stamp]
//   Tiiiiiiiildd..  29-bit                   T.. r.. R.. the same
//   riiil Riiiiiiiil  remote frames          Fxx       status flags
//   F V v N     status, versions, serial     Vxxxx vxxxx Nxxxx
//   Z0 Z1       time stamps off, on          sxrrrttt  bus state and counters (kernel)
//   X0 X1       auto-poll off, on            enc..     n bus errors by letter
//   P A         fetch one frame, all         A CR      after the last frame that A fetched
//   Mxxxxxxxx mxxxxxxxx W0 W1  filter (acceptance_filter.h)
//   U0..U6      speed of the serial line
//
// Worked example: T0CF0298080000007D00007DCC00 CR is identifier 0CF02980, eight bytes 00 .. 00.
// Numbers are hexadecimal, sent in upper case, read in either. A line ends with CR; LF is skipped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::slcan {

inline constexpr std::uint8_t kEnd = '\r';
inline constexpr std::uint8_t kBell = 0x07;

/// Longest line without its CR: type, identifier, length digit, data, time stamp.
inline constexpr std::size_t kLongestLine = 1 + 8 + 1 + 2 * 8 + 4;
static_assert(kLongestLine == 30);

/// Time stamps count milliseconds modulo this.
inline constexpr unsigned kTimeStampModulus = 60'000;

enum class Verb : std::uint8_t {
  open,
  listen_only,
  close,
  bit_rate,    ///< number: 0..9.
  bit_timing,  ///< number: the two register bytes.
  frame,       ///< frame.
  status_flags,
  version,
  detailed_version,
  serial_number,
  time_stamps,  ///< number: 0 or 1.
  auto_poll,    ///< number: 0 or 1.
  poll,
  poll_all,
  acceptance_code,  ///< number: the four registers.
  acceptance_mask,  ///< number: the four registers.
  filter_mode,      ///< number: 0 dual, 1 single.
  line_speed,       ///< number: 0..6.
};

/// What a host asks for.
struct Command {
  Verb verb = Verb::close;
  std::uint32_t number = 0;
  can::Frame frame;

  friend bool operator==(const Command&, const Command&) = default;
};

enum class ReplyKind : std::uint8_t {
  done,          ///< CR.
  refused,       ///< BEL.
  frame_taken,   ///< z or Z.
  frame,         ///< frame, time_stamp_ms.
  status_flags,  ///< number: the flags.
  information,   ///< V, v or N with their text, ignored.
  bus_state,     ///< state, receive_errors, transmit_errors.
  bus_errors,    ///< number: the letters, by bit.
  all_polled,    ///< A: no more frames.
};

/// The letters of an error line as bits, in the order abBcfoOs.
enum ErrorLetter : std::uint16_t {
  kNoAcknowledge = 0x01,
  kDominantBit = 0x02,
  kRecessiveBit = 0x04,
  kCrcError = 0x08,
  kFormError = 0x10,
  kReceiveOverflow = 0x20,
  kTransmitOverflow = 0x40,
  kStuffError = 0x80,
};

/// What an adapter says.
struct Reply {
  ReplyKind kind = ReplyKind::done;
  std::uint16_t number = 0;
  can::Frame frame;
  std::optional<std::uint16_t> time_stamp_ms;
  can::ErrorState state = can::ErrorState::active;
  std::uint16_t receive_errors = 0;
  std::uint16_t transmit_errors = 0;

  friend bool operator==(const Reply&, const Reply&) = default;
};

/// One command, without its CR. Never incomplete: the line is all there is.
[[nodiscard]] Decoded<Command> parse_command(std::span<const std::uint8_t> line);
/// One reply, without its CR; a lone BEL is a reply of its own.
[[nodiscard]] Decoded<Reply> parse_reply(std::span<const std::uint8_t> line);

/// A line with its end, ready to be written.
struct Text {
  std::array<std::uint8_t, kLongestLine + 1> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> span() const { return std::span(bytes).first(size); }
  void push(std::uint8_t byte) { bytes[size++] = byte; }
};

/// Precondition: the frame's length is 0..8 and its identifier fits its format.
[[nodiscard]] Text write_frame(const can::Frame& frame,
                               std::optional<std::uint16_t> time_stamp_ms = std::nullopt);
[[nodiscard]] Text write_command(const Command& command);
[[nodiscard]] Text write_reply(const Reply& reply);

/// Cuts a byte stream into lines. Over-long lines are dropped whole, whatever their length, and
/// reported once; memory stays bounded by kLongestLine.
class LineSplitter {
 public:
  struct Line {
    std::span<const std::uint8_t> text;  ///< Valid until the next push.
    bool too_long = false;               ///< The text was dropped.
  };
  /// The line that `byte` completes: at CR, or at BEL (then the text is the BEL itself, and what
  /// came before it is dropped, as it cannot be a line).
  [[nodiscard]] std::optional<Line> push(std::uint8_t byte);

 private:
  std::array<std::uint8_t, kLongestLine> buffer_{};
  std::size_t size_ = 0;
  bool too_long_ = false;
};

// The lines by which an adapter in the Linux kernel's dialect reports on its controller: s with
// state and counters, e with errors (slc_bump_state and slc_bump_err of its slcan-core.c).
//
//   sw000097   warning, receive counter 0, transmit counter 97; a w p b = active .. bus-off
//   e2as       two errors: no acknowledge, stuff error
//   letters    a acknowledge, b dominant bit, B recessive bit, c CRC, f form, s stuff error;
//              o receive overflow, O transmit overflow
//
// What has no letter (where in the frame, a lost arbitration) is not carried.

/// The state line of a report that is about the state.
[[nodiscard]] std::optional<Reply> state_line(const can::ControllerReport& report);
/// The error line of a report that is about errors or overflows.
[[nodiscard]] std::optional<Reply> error_line(const can::ControllerReport& report);

/// What a state line (state, counters) or an error line (one error, overflows) says; of several
/// errors in one line the last letter's. Precondition: reply is of one of the two kinds.
[[nodiscard]] can::ControllerReport report_of(const Reply& reply);

}  // namespace rigwire::protocols::slcan
