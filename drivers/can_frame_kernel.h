// Frames and reports as the kernel's struct can_frame, and back.
//
// Source: Linux, include/uapi/linux/can.h.
#pragma once

#include <linux/can.h>

#include <optional>

#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"

namespace rigwire::drivers {

[[nodiscard]] can_frame to_kernel(const protocols::can::Frame& frame);
[[nodiscard]] can_frame to_kernel(const protocols::can::ControllerReport& report);

/// Precondition: not an error frame.
[[nodiscard]] protocols::can::Frame from_kernel(const can_frame& in);
/// Nothing when it is no error frame.
[[nodiscard]] std::optional<protocols::can::ControllerReport> report_from_kernel(
    const can_frame& in);

}  // namespace rigwire::drivers
