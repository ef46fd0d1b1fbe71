// A device that is a unit of a Modbus line. The line (ModbusServer on TCP) frames and answers; the
// device only knows its registers, so that it is the same on every kind of line.
#pragma once

#include "emulators/device.h"
#include "emulators/modbus/modbus_unit.h"

namespace rigwire::emulators {

class ModbusDevice : public Device {
 public:
  /// What the line asks. Lives as long as the device; its advance() is this device's.
  [[nodiscard]] virtual ModbusUnit& unit() = 0;
};

}  // namespace rigwire::emulators
