// Where a rig's USB devices are plugged in, whatever exports them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "emulators/usb/usb_device.h"

namespace rigwire::hil {

class UsbBus {
 public:
  /// Number of a socket, never reused within a run.
  using Socket = std::uint16_t;
  virtual ~UsbBus() = default;

  /// Plugs `device` in from the start of the run; it must outlive every use of the bus. `name` is
  /// what a client sees in the list. The bus lets the device live (advance) from then on. Throws
  /// std::invalid_argument when the device's description is not valid.
  virtual Socket plug(emulators::UsbDevice& device, std::string_view name) = 0;
  /// Pulls the device out, or puts it back.
  virtual void set_plugged(SimTime now, Socket socket, bool plugged) = 0;
  /// The device is out from `from` until before `until`. To be called before the run.
  virtual void schedule_unplug(Socket socket, SimTime from, SimTime until) = 0;
  /// A client has the device.
  [[nodiscard]] virtual bool imported(Socket socket) const = 0;
  /// What a client attaches: "usb 127.0.0.1:3240 1-1".
  [[nodiscard]] virtual std::string address(Socket socket) const = 0;
  /// Present simulated time.
  [[nodiscard]] virtual SimTime now() const = 0;
};

}  // namespace rigwire::hil
