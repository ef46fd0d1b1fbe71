// The host's side of USB: real devices, and those that the kernel has attached by USB/IP, through
// libusb.
//
// Everything runs on the io_context: libusb's descriptors are watched by it, and completions and
// news of devices come from within io_context::poll()/run(). Setting up (listing, opening,
// claiming) blocks for a few control transfers; transfers do not.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <vector>

#include "drivers/endpoints.h"
#include "drivers/usb_device_handle.h"
#include "drivers/usb_selector.h"

namespace rigwire::drivers {

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

  /// `watcher` hears of every device that comes or goes from now on. News come from udev: a system
  /// without udevd (a bare initramfs) has none. Throws EndpointError when libusb cannot tell.
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
