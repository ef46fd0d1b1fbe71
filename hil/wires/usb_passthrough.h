// Passes a real USB device on: a client of the rig's USB bus attaches a device that this machine's
// libusb has opened as if it were plugged in there.
//
// Descriptors are read from the device once. Class and vendor requests and transfers go to the
// device and back; the standard requests are answered here (usb_standard_requests.h), so that
// alternate settings other than the first, and other configurations, are not reachable. A halt of
// a USB endpoint is cleared on the device at once, as the client's CLEAR_FEATURE does not reach it.
// Isochronous endpoints do not exist here. A client that takes the device does not reset it.
//
// The device answers in wall time, so that it needs a clock that follows that.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "drivers/usb_device_handle.h"
#include "emulators/usb/usb_device.h"

namespace rigwire::hil {

class UsbPassThrough final : public emulators::UsbDevice {
 public:
  /// Takes all interfaces from the kernel's drivers. Throws drivers::EndpointError.
  explicit UsbPassThrough(std::unique_ptr<drivers::UsbDeviceHandle> device);
  ~UsbPassThrough() override;

  [[nodiscard]] const protocols::usb::DeviceDescription& description() const override {
    return description_;
  }
  void plugged(SimTime now, emulators::UsbHost& host) override;
  void unplugged(SimTime now) override;
  void control(SimTime now, emulators::UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data) override;
  void read(SimTime now, emulators::UsbTransfer transfer, std::uint8_t endpoint,
            std::size_t length) override;
  void write(SimTime now, emulators::UsbTransfer transfer, std::uint8_t endpoint,
             std::span<const std::uint8_t> data) override;
  [[nodiscard]] bool cancel(SimTime now, emulators::UsbTransfer transfer) override;
  void advance(SimTime now) override { now_ = now; }

  [[nodiscard]] const drivers::UsbDeviceHandle& device() const { return *device_; }
  /// Returns the last control transfer that the client began.
  [[nodiscard]] const std::optional<emulators::UsbRequest>& last_request() const {
    return last_request_;
  }

 private:
  using Outcome = protocols::usb::Outcome;
  /// Returns the completion of a transfer that the client knows as `transfer`.
  [[nodiscard]] drivers::UsbDeviceHandle::Done passing_on(emulators::UsbTransfer transfer,
                                                          std::uint8_t endpoint);

  std::unique_ptr<drivers::UsbDeviceHandle> device_;
  protocols::usb::DeviceDescription description_;
  emulators::UsbHost* host_ = nullptr;
  SimTime now_ = kStart;
  std::optional<emulators::UsbRequest> last_request_;
  /// The client's numbers to the device's.
  std::map<emulators::UsbTransfer, drivers::UsbDeviceHandle::Transfer> open_;
  /// Counts clients, so that transfers of an earlier client are ignored.
  std::uint64_t client_ = 0;
};

}  // namespace rigwire::hil
