// A real USB device of this machine as a device of the rig: opened by libusb, exported by the rig's
// USB bus.
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string_view>

#include "hil/devices/device_line.h"
#include "hil/devices/usb_passthrough_configuration.h"
#include "hil/wires/usb_bus.h"

namespace rigwire::hil {

/// `bus` must outlive the line. Throws drivers::EndpointError when the device is not there or may
/// not be opened, std::invalid_argument when its descriptors are not valid.
[[nodiscard]] std::unique_ptr<DeviceLine> make_line(
    const UsbPassThroughConfiguration& configuration, boost::asio::io_context& io, UsbBus& bus,
    std::string_view name);

}  // namespace rigwire::hil
