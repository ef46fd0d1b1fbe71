// Attaches a USB device that a USB/IP server exports to this machine's kernel: what
// `usbip attach -r HOST -b BUS_ID` does, without that program.
//
// The kernel's virtual host controller (module vhci-hcd) takes over a connected socket on which the
// device has been imported; root only.
//
// Source: Linux 6.1, drivers/usb/usbip/vhci_sysfs.c, tools/usb/usbip/src/usbip_attach.c.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace rigwire::drivers {

/// Why this process cannot attach devices, with its mend; empty: it can.
[[nodiscard]] std::string vhci_obstacle();

/// A free port for devices up to high speed, out of the controller's attribute `status`.
[[nodiscard]] std::optional<unsigned> free_vhci_port(std::string_view status);

class VhciAttachment {
 public:
  /// `error` is empty when the device is attached.
  using Done = std::function<void(const std::string& error)>;

  /// Imports `bus_id` from the server at a numeric address and hands it to the kernel. `done` comes
  /// once, from within the io_context.
  VhciAttachment(boost::asio::io_context& io, const std::string& address, std::uint16_t port,
                 std::string bus_id, Done done);
  /// Detaches the device.
  ~VhciAttachment();
  VhciAttachment(const VhciAttachment&) = delete;
  VhciAttachment& operator=(const VhciAttachment&) = delete;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace rigwire::drivers
