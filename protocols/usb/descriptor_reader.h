// What a host makes of a device's descriptors.
//
// The reader goes by the descriptors' own lengths, as a host does: descriptors that it does not
// know are kept as bytes with the interface that they follow.
//
// Source: Universal Serial Bus Specification 2.0, 9.5, 9.6.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocols/result.h"
#include "protocols/usb/descriptors.h"

namespace rigwire::protocols::usb {

/// Table 9-8, with the numbers of the strings instead of their texts.
struct DeviceDescriptor {
  std::uint16_t usb_version = 0;
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
  std::uint8_t control_packet_bytes = 0;
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t release = 0;
  std::uint8_t manufacturer_text = 0;
  std::uint8_t product_text = 0;
  std::uint8_t serial_text = 0;
  std::uint8_t configurations = 0;
};

/// One interface in one alternate setting; `interface.text` stays empty.
struct InterfaceDescriptor {
  InterfaceDescription interface;
  std::uint8_t text = 0;
};

struct ConfigurationDescriptor {
  /// Number in the descriptor; `interfaces` also lists alternates.
  std::uint8_t interface_count = 0;
  std::uint8_t value = 0;
  std::uint8_t text = 0;
  bool self_powered = false;
  bool remote_wakeup = false;
  std::uint8_t maximum_power_2ma = 0;
  std::vector<std::uint8_t> extra;  ///< Descriptors before the first interface.
  std::vector<InterfaceDescriptor> interfaces;
};

[[nodiscard]] Decoded<DeviceDescriptor> decode_device(std::span<const std::uint8_t> bytes);

/// Takes the whole configuration, total length long. Malformed: a descriptor shorter than its kind
/// or longer than what is left, more or fewer endpoints than the interface says, another number of
/// interfaces than announced.
[[nodiscard]] Decoded<ConfigurationDescriptor> decode_configuration(
    std::span<const std::uint8_t> bytes);

/// A string descriptor's text in UTF-8.
[[nodiscard]] Decoded<std::string> decode_text(std::span<const std::uint8_t> bytes);

}  // namespace rigwire::protocols::usb
