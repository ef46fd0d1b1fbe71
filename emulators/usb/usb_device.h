// What every emulated USB device has: descriptors, and transfers that the host asks for.
//
// A device is a state machine over simulated time like every other (emulators/device.h). The host
// (USB/IP's, a test) hands it transfers, each with a number of the host's choice that is unique
// among those open on the device; the device ends each exactly once by UsbHost::complete(), at once
// or later (an interrupt endpoint without news keeps its transfer until there is some).
//
// The standard requests of chapter 9 are answered by UsbStandardRequests (usb_standard_requests.h)
// for every device alike; a device sees only its class and vendor requests, the descriptors of its
// classes, and its endpoints, all by way of a UsbPort (usb_port.h), which lets nothing else pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/usb/descriptors.h"
#include "protocols/usb/transfer.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Number of one transfer, chosen by the host.
using UsbTransfer = std::uint32_t;

/// A control transfer of the client, for viewers.
struct UsbRequest {
  SimTime at{};
  protocols::usb::Setup setup;
};

/// Where a device ends its transfers.
class UsbHost {
 public:
  virtual ~UsbHost() = default;
  /// `data` holds what goes to the host (never more than was asked for; empty for transfers from
  /// the host); `taken` counts the bytes taken of a transfer from the host. The bytes are copied
  /// before the call returns.
  virtual void complete(SimTime now, UsbTransfer transfer, protocols::usb::Outcome outcome,
                        std::span<const std::uint8_t> data, std::size_t taken) = 0;
};

class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  /// Constant for the life of the device.
  [[nodiscard]] virtual const protocols::usb::DeviceDescription& description() const = 0;

  /// A host has the device from now on (import, plug, reset): back to the state after power-on.
  /// `host` is valid until unplugged().
  virtual void plugged(SimTime now, UsbHost& host) = 0;
  /// The host is gone. Open transfers are forgotten: complete() must not be called for them.
  virtual void unplugged(SimTime now) = 0;
  /// SET_CONFIGURATION; 0 is unconfigured.
  virtual void configured(SimTime /*now*/, std::uint8_t /*configuration*/) {}
  /// SET_INTERFACE, to an alternate setting that the description has.
  virtual void selected(SimTime /*now*/, std::uint8_t /*interface*/, std::uint8_t /*alternate*/) {}

  /// A class or vendor request, or GET_DESCRIPTOR for a descriptor of an interface's class (type 1,
  /// recipient interface); `data` is what the host sends along (setup.length bytes), empty for
  /// requests to the host. An answer may be cut to setup.length by complete_to() of usb_port.h.
  virtual void control(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
                       std::span<const std::uint8_t> data) = 0;
  /// The host wants up to `length` bytes from an IN endpoint (address with bit 7 set).
  virtual void read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
                    std::size_t length) = 0;
  /// The host sends bytes to an OUT endpoint: one transfer, whole. `data` is valid during the call.
  virtual void write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
                     std::span<const std::uint8_t> data) = 0;
  /// The host takes a transfer back. True when it was still open: it is forgotten, complete() will
  /// not be called. False when it has been completed (or never was).
  [[nodiscard]] virtual bool cancel(SimTime now, UsbTransfer transfer) = 0;

  /// Lets the device live up to and including `now`; see Device.
  virtual void advance(SimTime /*now*/) {}
  [[nodiscard]] virtual SimTime next_event() const { return kNever; }

 protected:
  UsbDevice() = default;
};

}  // namespace rigwire::emulators
