// What this machine offers for USB: to attach a rig's emulated devices, and to pass real ones on.
#pragma once

#include <vector>

#include "hil/command_line/doctor.h"

namespace rigwire::hil {

/// "USB/IP" (attaching emulated devices here: vhci-hcd and rights), "gs_usb" (the driver of an
/// emulated CAN adapter), "usbip" (the program that attaches by hand) and "USB devices" (what
/// libusb sees).
[[nodiscard]] std::vector<Finding> examine_usb();

}  // namespace rigwire::hil
