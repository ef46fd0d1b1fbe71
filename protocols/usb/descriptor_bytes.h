// The bytes of a device's descriptors, made once from its description.
//
// Strings are numbered from 1 in this order, empty ones left out: manufacturer, product, serial
// number, the interfaces' texts in the order of the interfaces. All are given in one language,
// English (United States).
//
// Source: Universal Serial Bus Specification 2.0, 9.6.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "protocols/usb/constants.h"
#include "protocols/usb/descriptors.h"

namespace rigwire::protocols::usb {

/// Throws std::invalid_argument naming what is out of range: packet sizes that the speed does not
/// allow (5.5.3, 5.7.3, 5.8.3), endpoint numbers outside 1 .. 15 or there twice in one alternate
/// setting, isochronous endpoints, interfaces not numbered from 0 up or whose alternates do not
/// begin with 0, extra bytes that are no row of descriptors, texts that are not UTF-8 or longer
/// than 126 UTF-16 units, a configuration value of 0, more than 65535 bytes in all.
void validate(const DeviceDescription& description);

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
