// How candleLight tells a host of its controller: error frames of SocketCAN.
//
// Source: candleLight_fw at 64dc8dc, src/can_common.c and src/can/bxcan.c.
#pragma once

#include <optional>

#include "protocols/can/controller_report.h"
#include "protocols/gs_usb/host_frame.h"

namespace rigwire::emulators {

/// The error frame for a report; nothing when the firmware would stay silent: it reports changes of
/// state, restarts, and single bus errors only with `bus_errors`. What a gs_usb host learns
/// otherwise (lost frames: a flag) or never (lost arbitration) makes no error frame.
[[nodiscard]] std::optional<protocols::gs_usb::HostFrame> gs_usb_error_frame(
    const protocols::can::ControllerReport& report, bool bus_errors);

}  // namespace rigwire::emulators
