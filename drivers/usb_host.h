// The host's side of USB: real devices, and those that the kernel has attached by USB/IP, through
// libusb.
//
// Everything runs on the io_context: libusb's descriptors are watched by it, and completions and
// news of devices come from within io_context::poll()/run(). Setting up (listing, opening,
// claiming) blocks for a few control transfers; transfers do not.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/endpoints.h"
#include "drivers/usb_device_handle.h"

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

/// Selects a device by text:
///
///   1d50:606f           vendor and product, hexadecimal
///   1d50:606f:0123AB    and serial number
///   1-1.4               bus and ports, as the kernel names the place where it is plugged in
struct UsbSelector {
  std::string place;  ///< Empty: by the numbers.
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string serial_number;  ///< Empty: any.

  [[nodiscard]] bool matches(const UsbListed& device) const;
};

/// Throws std::invalid_argument with the text and the forms that are allowed.
[[nodiscard]] UsbSelector parse_usb_selector(std::string_view text);

/// What is plugged in now, in the order of bus and address. Texts are the kernel's: reading them
/// needs no permission and does not touch the devices. Throws EndpointError when libusb cannot be
/// used at all.
[[nodiscard]] std::vector<UsbListed> list_usb_devices();

class UsbHost {
 public:
  /// `arrived` false: it is gone; its texts are empty then.
  using DeviceWatcher = std::function<void(const UsbListed&, bool arrived)>;

  /// Throws EndpointError when libusb cannot be used.
  explicit UsbHost(boost::asio::io_context& context);
  ~UsbHost();
  UsbHost(const UsbHost&) = delete;
  UsbHost& operator=(const UsbHost&) = delete;

  /// Calls `watcher` for every device that comes or goes from now on. The events come from udev: a
  /// system without udevd (a bare initramfs) has none. Throws EndpointError when libusb cannot
  /// report them.
  void on_device(DeviceWatcher watcher);

  /// The first device that `selector` matches. Throws EndpointError: nothing matches (the message
  /// lists what is there), or this user may not open it (the message has the udev rule). The handle
  /// must not outlive the host.
  [[nodiscard]] std::unique_ptr<UsbDeviceHandle> open(const UsbSelector& selector);

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace rigwire::drivers
