// CAN over TCP in the protocol of the daemon socketcand: elements of ASCII between < and >.
//
// Sources: linux-can/socketcand, doc/protocol.md, and where it is silent the daemon itself (version
// of May 2025: socketcand.c, state_nobus.c, state_bcm.c, state_raw.c, state_control.c).
//
//   client to daemon                            daemon to client
//   < open can0 >                               < hi >           after connecting
//   < rawmode > < bcmmode > < controlmode >     < ok >           mode or bus taken
//   < send ID LENGTH BYTE.. >                   < frame ID SECONDS.MICROSECONDS DATA >
//   < add S US ID LENGTH BYTE.. >               < error CLASS SECONDS.MICROSECONDS >
//   < update ID LENGTH BYTE.. > < delete ID >   < error TEXT >
//   < subscribe S US ID > < unsubscribe ID >    < stat RBYTES RPACKETS TBYTES TPACKETS >
//   < filter S US ID LENGTH MASK.. >            < echo >
//   < muxfilter S US ID COUNT MASK.. >
//   < statistics MILLISECONDS > < echo >
//
// Worked example: "< send 1AAAAAAA 2 1 f1 >" is a 29-bit identifier with the bytes 01 F1. Numbers
// of frames are hexadecimal, LENGTH, COUNT and times decimal. An identifier of exactly eight digits
// has 29 bits, a shorter one 11. The daemon sends a shorter one beyond 7FF as what is left of it in
// 11 bits; here it can only mean 29: python-can before 4.2 writes identifiers without their leading
// zeros. Bit 30 of eight digits is a remote request, as in the kernel's identifiers.
//
// Not taken, as unknown commands: the mode for ISO-TP, and bit timings and control modes of an
// interface, which the daemon has only when it was built for them.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/can/frame.h"

namespace rigwire::protocols::socketcand {

inline constexpr std::uint16_t kPort = 29536;
inline constexpr std::uint16_t kBeaconPort = 42000;
/// The longest element: < muxfilter > with its masks, 3 characters for each byte.
inline constexpr std::size_t kLongestElement = 64 + 257 * 8 * 3;
inline constexpr std::size_t kMostMasks = 257;

using Mask = std::array<std::uint8_t, 8>;

enum class Verb : std::uint8_t {
  unknown,
  malformed,  ///< A known word with arguments that make no sense; the daemon is silent to it.
  open,       ///< bus.
  raw_mode,
  bcm_mode,
  control_mode,
  echo,
  send,         ///< frame.
  add,          ///< frame, interval.
  update,       ///< frame.
  remove,       ///< frame's identifier.
  subscribe,    ///< frame's identifier, interval.
  filter,       ///< frame's identifier, interval, masks: one.
  mux_filter,   ///< frame's identifier, masks: the multiplexer's, then one for each value.
  unsubscribe,  ///< frame's identifier.
  statistics,   ///< interval; 0 = none.
};

struct Command {
  Verb verb = Verb::unknown;
  std::string bus;
  can::Frame frame;
  std::chrono::microseconds interval{0};
  std::vector<Mask> masks;
};

/// An element with its brackets, or without.
[[nodiscard]] Command parse_command(std::string_view element);

/// Splits a stream into elements. Bytes between them are skipped.
class ElementSplitter {
 public:
  /// The whole element with its brackets, when this byte ends one. Valid until the next push().
  std::optional<std::string_view> push(char byte);
  /// An element got longer than any that means something.
  [[nodiscard]] bool overflowed() const { return overflowed_; }

 private:
  std::string element_;
  bool ended_ = false;
  bool overflowed_ = false;
};

/// Time since 1970, as the kernel stamps frames.
using Stamp = std::chrono::microseconds;

/// How a frame's data are written: together in raw mode, byte by byte in BCM mode.
enum class DataStyle : std::uint8_t { together, apart };

[[nodiscard]] std::string frame_element(const can::Frame& frame, Stamp stamp, DataStyle style);
/// `error_class` without the kernel's flag of error frames.
[[nodiscard]] std::string error_element(std::uint32_t error_class, Stamp stamp);

struct Statistics {
  std::uint32_t received_bytes = 0;
  std::uint32_t received_frames = 0;
  std::uint32_t sent_bytes = 0;
  std::uint32_t sent_frames = 0;
};
[[nodiscard]] std::string statistics_element(const Statistics& statistics);

/// The datagram by which the daemon makes itself known.
[[nodiscard]] std::string beacon(std::string_view name, std::string_view description,
                                 std::string_view address, std::uint16_t port,
                                 const std::vector<std::string>& buses);

}  // namespace rigwire::protocols::socketcand
