// One Modbus request to one unit: the unit does it, the answer comes back as a response.
#pragma once

#include "emulators/modbus/modbus_server.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Carries out `request`. Function 23 checks that the read will be possible, then writes, then
/// reads (V1.1b3, section 6.17: the write comes first), so that a refused read writes nothing.
/// Function 22 reads and writes one holding register. Never throws.
[[nodiscard]] protocols::modbus::Response dispatch(SimTime now, ModbusUnit& unit,
                                                   const protocols::modbus::Request& request);

}  // namespace rigwire::emulators
