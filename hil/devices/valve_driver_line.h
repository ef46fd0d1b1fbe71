// A valve driver of the rig on a Modbus line, a shared one or its own.
#pragma once

#include <memory>

#include "hil/devices/device_line.h"
#include "hil/wires/rig_modbus.h"

namespace rigwire::hil {

/// `shared` must outlive the line; without it the driver has a TCP server of its own. Opens that
/// one's endpoint and throws drivers::EndpointError when that fails.
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(const ValveDriverConfiguration& configuration,
                                                    const LineContext& context, ModbusLine* shared);

}  // namespace rigwire::hil
