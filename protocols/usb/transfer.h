// The terms in which a USB host and a device talk, whatever carries them: how transfers end, the
// eight bytes that begin a control transfer, numbers of the standard requests and descriptors.
//
// Source: Universal Serial Bus Specification 2.0, 9.3 and table 9-2 (setup data, request type),
// tables 9-4 (requests), 9-5 (descriptor types), 9-6 (features).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/bytes.h"

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

/// Bits 6..5 of the request type.
enum class RequestKind : std::uint8_t { standard = 0, by_class = 1, vendor = 2, reserved = 3 };
/// Bits 4..0 of the request type; higher numbers are reserved.
enum class Recipient : std::uint8_t { device = 0, interface = 1, endpoint = 2, other = 3 };

enum class StandardRequest : std::uint8_t {
  get_status = 0,
  clear_feature = 1,
  set_feature = 3,
  set_address = 5,
  get_descriptor = 6,
  set_descriptor = 7,
  get_configuration = 8,
  set_configuration = 9,
  get_interface = 10,
  set_interface = 11,
  synch_frame = 12,
};

enum class Feature : std::uint16_t { endpoint_halt = 0, remote_wakeup = 1, test_mode = 2 };

namespace descriptor_type {
inline constexpr std::uint8_t kDevice = 1;
inline constexpr std::uint8_t kConfiguration = 2;
inline constexpr std::uint8_t kString = 3;
inline constexpr std::uint8_t kInterface = 4;
inline constexpr std::uint8_t kEndpoint = 5;
inline constexpr std::uint8_t kDeviceQualifier = 6;  ///< High-speed devices only: 9.6.2.
}  // namespace descriptor_type

inline constexpr std::size_t kDeviceDescriptorSize = 18;
inline constexpr std::size_t kConfigurationDescriptorSize = 9;
inline constexpr std::size_t kInterfaceDescriptorSize = 9;
inline constexpr std::size_t kEndpointDescriptorSize = 7;
/// One descriptor's length is a byte; a configuration's total length two.
inline constexpr std::size_t kDescriptorMaximum = 255;
inline constexpr std::size_t kConfigurationMaximum = 65535;

inline constexpr std::uint16_t kEnglishUnitedStates = 0x0409;  ///< Language of all strings here.

inline constexpr std::size_t kSetupSize =
    1 /* request type */ + 1 /* request */ + 2 /* value */ + 2 /* index */ + 2 /* length */;
static_assert(kSetupSize == 8);

using SetupBytes = std::array<std::uint8_t, kSetupSize>;

[[nodiscard]] constexpr Setup decode_setup(std::span<const std::uint8_t, kSetupSize> bytes) {
  return {bytes[0], bytes[1], load_little<std::uint16_t>(bytes, 2),
          load_little<std::uint16_t>(bytes, 4), load_little<std::uint16_t>(bytes, 6)};
}

[[nodiscard]] constexpr SetupBytes encode_setup(const Setup& setup) {
  SetupBytes bytes{setup.request_type, setup.request};
  store_little(bytes, 2, setup.value);
  store_little(bytes, 4, setup.index);
  store_little(bytes, 6, setup.length);
  return bytes;
}

[[nodiscard]] constexpr RequestKind kind_of(const Setup& setup) {
  return static_cast<RequestKind>((setup.request_type >> 5U) & 3U);
}
[[nodiscard]] constexpr std::uint8_t recipient_number(const Setup& setup) {
  return setup.request_type & 0x1FU;
}
[[nodiscard]] constexpr bool is_for(const Setup& setup, Recipient recipient) {
  return recipient_number(setup) == static_cast<std::uint8_t>(recipient);
}

/// The first byte, from its parts.
[[nodiscard]] constexpr std::uint8_t request_type(bool to_host, RequestKind kind,
                                                  Recipient recipient) {
  return static_cast<std::uint8_t>((to_host ? 0x80U : 0U) | (static_cast<unsigned>(kind) << 5U) |
                                   static_cast<unsigned>(recipient));
}

}  // namespace rigwire::protocols::usb
