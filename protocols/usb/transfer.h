// The terms in which a USB host and a device talk, whatever carries them.
//
// Source: Universal Serial Bus Specification 2.0, 9.3 (setup data), 9.4 (standard requests).
#pragma once

#include <cstdint>

namespace rigwire::protocols::usb {

/// Table 9-2. Little endian on the wire, eight bytes.
struct Setup {
  std::uint8_t request_type = 0;  ///< Bit 7 device to host; bits 6..5 type; bits 4..0 recipient.
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;

  [[nodiscard]] bool to_host() const { return (request_type & 0x80U) != 0; }
  friend bool operator==(const Setup&, const Setup&) = default;
};

enum class Speed : std::uint8_t { low = 1, full = 2, high = 3 };  // numbers of USB/IP

enum class TransferType : std::uint8_t { control = 0, isochronous = 1, bulk = 2, interrupt = 3 };

/// How a transfer ends.
enum class Outcome : std::uint8_t {
  done,       ///< Possibly short.
  stalled,    ///< The endpoint refuses; a control request that the device does not know.
  overflow,   ///< More arrived than was asked for.
  cancelled,  ///< By the host.
  gone,       ///< The device was unplugged.
};

/// Endpoint addresses carry the direction in bit 7.
inline constexpr std::uint8_t kToHost = 0x80;

}  // namespace rigwire::protocols::usb
