// Which USB device is meant, as text.
//
//   1d50:606f           vendor and product, hexadecimal
//   1d50:606f:0123AB    and serial number
//   1-1.4               bus and ports, as the kernel names the place where it is plugged in
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rigwire::drivers {

/// One device as a list shows it.
struct UsbListed {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint8_t bus = 0;
  std::uint8_t address = 0;    ///< On the bus; another one each time it is plugged in.
  std::string place{};         ///< "1-1.4"; "usb1" for the root of a bus.
  std::string manufacturer{};  ///< Texts: empty when the device has none.
  std::string product_name{};
  std::string serial_number{};
  bool permitted = false;  ///< This user may open it.
};

struct UsbSelector {
  std::string place;  ///< Empty: by the numbers.
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string serial_number;  ///< Empty: any.

  [[nodiscard]] bool matches(const UsbListed& device) const;
};

/// Throws std::invalid_argument with the text and the forms that are allowed.
[[nodiscard]] UsbSelector parse_usb_selector(std::string_view text);

}  // namespace rigwire::drivers
