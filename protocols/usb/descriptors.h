// What a USB device says about itself, as structures; and as the bytes that GET_DESCRIPTOR returns.
//
// Source: Universal Serial Bus Specification 2.0, 9.5 and 9.6.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/usb/transfer.h"

namespace rigwire::protocols::usb {

/// Table 9-13.
struct EndpointDescription {
  std::uint8_t address = 0;  ///< Number 1 .. 15, kToHost for IN.
  TransferType type = TransferType::bulk;
  std::uint16_t packet_bytes = 64;
  std::uint8_t interval = 0;  ///< Frames (interrupt, full speed); 0 for bulk.
};

/// Table 9-12; `extra` is what follows it in the configuration: class-specific descriptors.
struct InterfaceDescription {
  std::uint8_t number = 0;
  std::uint8_t alternate = 0;
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
  std::string text;  ///< Empty: no string.
  std::vector<std::uint8_t> extra;
  std::vector<EndpointDescription> endpoints;
};

/// Table 9-8 and one configuration (Table 9-10), which is all that the devices here have.
struct DeviceDescription {
  std::uint16_t usb_version = 0x0200;  ///< Binary coded decimal.
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
  std::uint8_t control_packet_bytes = 64;
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t release = 0x0100;  ///< Binary coded decimal.
  std::string manufacturer;        ///< Texts: UTF-8; empty ones are left out.
  std::string product_name;
  std::string serial_number;
  Speed speed = Speed::full;
  bool self_powered = false;
  std::uint8_t maximum_power_2ma = 50;  ///< In units of 2 mA.
  std::uint8_t configuration_value = 1;
  std::vector<InterfaceDescription> interfaces;
};

// USB strings are UTF-16, everything else here is UTF-8 (RFC 3629, section 3 and 4; RFC 2781,
// section 2).
/// Nothing when the text is not well-formed UTF-8 (overlong, surrogate, cut, beyond 10FFFF).
[[nodiscard]] std::optional<std::u16string> utf16_from_utf8(std::string_view text);

/// Unpaired surrogates become U+FFFD.
[[nodiscard]] std::string utf8_from_utf16(std::u16string_view text);

/// Throws std::invalid_argument naming what is out of range: packet sizes that the speed does not
/// allow (5.5.3, 5.7.3, 5.8.3), endpoint numbers outside 1 .. 15 or there twice in one alternate
/// setting, isochronous endpoints, interfaces not numbered from 0 up or whose alternates do not
/// begin with 0, extra bytes that are no row of descriptors, texts that are not UTF-8 or longer
/// than 126 UTF-16 units, a configuration value of 0, more than 65535 bytes in all.
void validate(const DeviceDescription& description);

/// The bytes of a device's descriptors, made once from its description. Strings are numbered from 1
/// in this order, empty ones left out: manufacturer, product, serial number, the interfaces' texts
/// in the order of the interfaces. All are given in one language, English (United States).
class DescriptorBytes {
 public:
  /// Throws std::invalid_argument, see validate().
  explicit DescriptorBytes(const DeviceDescription& description);

  [[nodiscard]] std::span<const std::uint8_t> device() const { return device_; }
  /// With its interfaces, endpoints and class-specific descriptors.
  [[nodiscard]] std::span<const std::uint8_t> configuration() const { return configuration_; }
  /// 0 gives the languages. Empty when there is no such string.
  [[nodiscard]] std::span<const std::uint8_t> text(std::size_t index) const {
    return index < texts_.size() ? std::span<const std::uint8_t>(texts_[index])
                                 : std::span<const std::uint8_t>{};
  }

 private:
  std::uint8_t add_text(std::string_view text);

  std::vector<std::uint8_t> device_;
  std::vector<std::uint8_t> configuration_;
  std::vector<std::vector<std::uint8_t>> texts_;
};

/// A string descriptor (9.6.7). Throws std::invalid_argument: not UTF-8, or too long.
[[nodiscard]] std::vector<std::uint8_t> encode_text(std::string_view utf8);

}  // namespace rigwire::protocols::usb
