// One device at one port of a host: what a host controller and the device's own protocol engine
// settle before the device's function receives a transfer.
//
// Control transfers go to the standard requests or to the device; transfers to endpoints that the
// present configuration does not have, or that are halted, stall. Every transfer that is submitted
// ends exactly once in UsbHost::complete(), unless cancel() takes it back or detach() forgets it.
//
// Source: Universal Serial Bus Specification 2.0, 5.5 to 5.8, 8.5.
#pragma once

#include <cstdint>
#include <span>

#include "emulators/usb/usb_device.h"
#include "emulators/usb/usb_standard_requests.h"

namespace rigwire::emulators {

/// Ends a request to the host with as much of `answer` as it asked for.
void complete_to(UsbHost& host, SimTime now, UsbTransfer transfer,
                 const protocols::usb::Setup& setup, std::span<const std::uint8_t> answer);

class UsbPort {
 public:
  /// `device` must outlive the port. Throws std::invalid_argument when its description is not
  /// valid.
  explicit UsbPort(UsbDevice& device) : device_(device), standard_(device) {}

  /// `host` must stay until detach().
  void attach(SimTime now, UsbHost& host);
  void detach(SimTime now);
  [[nodiscard]] bool attached() const { return host_ != nullptr; }

  // For an attached port. Numbers of transfers are unique among the open ones.
  /// `data` is what goes to the device: setup.length bytes, none for requests to the host.
  void control(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data);
  /// `endpoint` with the direction in bit 7.
  void read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint, std::size_t length);
  void write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
             std::span<const std::uint8_t> data);
  /// See UsbDevice::cancel().
  [[nodiscard]] bool cancel(SimTime now, UsbTransfer transfer) {
    return device_.cancel(now, transfer);
  }

  [[nodiscard]] UsbDevice& device() const { return device_; }
  [[nodiscard]] const UsbStandardRequests& standard() const { return standard_; }

 private:
  [[nodiscard]] bool usable(std::uint8_t endpoint) const;
  void stall(SimTime now, UsbTransfer transfer);

  UsbDevice& device_;
  UsbStandardRequests standard_;
  UsbHost* host_ = nullptr;
};

}  // namespace rigwire::emulators
