// A USB joystick of the rig with what moves its levers.
#pragma once

#include <memory>
#include <string_view>

#include "hil/devices/device_line.h"
#include "hil/devices/usb_joystick.h"
#include "hil/wires/usb_bus.h"

namespace rigwire::hil {

class JoystickLine : public DeviceLine {
 public:
  /// The levers follow what these valves are told; they must outlive the line. For lines whose
  /// source is `commands`; before the run.
  virtual void follow(const emulators::ValveBackend& valves) = 0;
};

/// `bus` must outlive the line. Throws std::invalid_argument.
[[nodiscard]] std::unique_ptr<JoystickLine> make_line(const UsbJoystickConfiguration& configuration,
                                                      UsbBus& bus, std::string_view name);

}  // namespace rigwire::hil
