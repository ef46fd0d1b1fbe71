// Numbers of the standard requests and descriptors.
//
// Source: Universal Serial Bus Specification 2.0, tables 9-2 (request type), 9-4 (requests), 9-5
// (descriptor types), 9-6 (features).
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigwire::protocols::usb {

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

}  // namespace rigwire::protocols::usb
