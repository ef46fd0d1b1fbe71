// A StarFire 3000 of the rig: one antenna, a serial line, a node of a CAN bus, or both.
#pragma once

#include <memory>

#include "hil/devices/device_line.h"
#include "hil/devices/starfire.h"

namespace rigwire::hil {

/// `bus` must outlive the line; null without a node. Opens the serial line, when there is one, and
/// throws drivers::EndpointError when that fails.
[[nodiscard]] std::unique_ptr<GnssLine> make_line(const StarFireConfiguration& configuration,
                                                  const LineContext& context, CanLine* bus);

}  // namespace rigwire::hil
