// What is said on a rig's CAN bus, from its configuration alone: the messages of all its devices.
#pragma once

#include <string>
#include <vector>

#include "hil/rig/rig_configuration.h"
#include "protocols/can/message_layout.h"

namespace rigwire::hil {

/// Each device under its name in the rig and with its configured address. Empty when the rig has no
/// such bus, or nobody on it says how its messages are laid out. Throws std::invalid_argument for
/// settings that make no device.
[[nodiscard]] std::vector<protocols::can::MessageLayout> bus_messages(const RigConfiguration& rig,
                                                                      const std::string& bus);

}  // namespace rigwire::hil
