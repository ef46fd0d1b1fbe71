// Communications class, abstract control model: a modem's serial line on USB.
//
// Source: USB Class Definitions for Communications Devices 1.2, 5.2.3 (functional descriptors);
// Subclass Specification for PSTN Devices 1.2, 5.3 (descriptors), 6.3 (requests), 6.5.4
// (SERIAL_STATE).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/bytes.h"
#include "protocols/usb/transfer.h"

namespace rigwire::protocols::usb::cdc {

inline constexpr std::uint8_t kCommunicationsClass = 2;
inline constexpr std::uint8_t kAbstractControlModel = 2;  ///< Subclass.
inline constexpr std::uint8_t kAtCommands = 1;            ///< Protocol V.250.
inline constexpr std::uint8_t kDataClass = 10;
inline constexpr std::uint8_t kClassInterface = 0x24;  ///< Type of functional descriptors.

/// Capabilities of the abstract control model's functional descriptor; a request without its bit
/// stalls.
inline constexpr std::uint8_t kHasLineCoding = 0x02;
inline constexpr std::uint8_t kHasBreak = 0x04;

enum class Request : std::uint8_t {
  set_line_coding = 0x20,
  get_line_coding = 0x21,
  set_control_line_state = 0x22,
  send_break = 0x23,
};
inline constexpr std::uint16_t kDataTerminalReady = 1;  ///< Bit of the control line state.
inline constexpr std::uint16_t kRequestToSend = 2;
inline constexpr std::uint16_t kBreakUntilCleared = 0xFFFF;  ///< Milliseconds of send_break.

enum class StopBits : std::uint8_t { one = 0, one_and_a_half = 1, two = 2 };
enum class Parity : std::uint8_t { none = 0, odd = 1, even = 2, mark = 3, space = 4 };

struct LineCoding {
  std::uint32_t rate_bps = 9600;
  StopBits stop = StopBits::one;
  Parity parity = Parity::none;
  std::uint8_t data_bits = 8;  ///< 5, 6, 7, 8 or 16.

  friend bool operator==(const LineCoding&, const LineCoding&) = default;
};

inline constexpr std::size_t kLineCodingSize =
    4 /* rate */ + 1 /* stop */ + 1 /* parity */ + 1 /* data bits */;

[[nodiscard]] constexpr std::array<std::uint8_t, kLineCodingSize> encode(const LineCoding& coding) {
  std::array<std::uint8_t, kLineCodingSize> bytes{};
  store_little(bytes, 0, coding.rate_bps);
  bytes[4] = static_cast<std::uint8_t>(coding.stop);
  bytes[5] = static_cast<std::uint8_t>(coding.parity);
  bytes[6] = coding.data_bits;
  return bytes;
}

/// Takes any values: whether a device can do them is the device's.
[[nodiscard]] constexpr LineCoding decode_line_coding(
    std::span<const std::uint8_t, kLineCodingSize> bytes) {
  return {load_little<std::uint32_t>(bytes, 0), static_cast<StopBits>(bytes[4]),
          static_cast<Parity>(bytes[5]), bytes[6]};
}

/// Table 31, bits of SERIAL_STATE; the three last are events and not kept.
namespace serial_state {
inline constexpr std::uint16_t kCarrier = 0x01;  ///< RS-232 CD.
inline constexpr std::uint16_t kReady = 0x02;    ///< RS-232 DSR.
inline constexpr std::uint16_t kBreak = 0x04;
inline constexpr std::uint16_t kRing = 0x08;
inline constexpr std::uint16_t kFramingError = 0x10;
inline constexpr std::uint16_t kParityError = 0x20;
inline constexpr std::uint16_t kOverrun = 0x40;
}  // namespace serial_state

inline constexpr std::size_t kSerialStateSize = kSetupSize /* header */ + 2 /* state */;
[[nodiscard]] constexpr std::array<std::uint8_t, kSerialStateSize> encode_serial_state(
    std::uint8_t interface, std::uint16_t state) {
  std::array<std::uint8_t, kSerialStateSize> bytes{0xA1, 0x20, 0, 0, interface, 0, 2, 0};
  store_little(bytes, kSetupSize, state);
  return bytes;
}

}  // namespace rigwire::protocols::usb::cdc
