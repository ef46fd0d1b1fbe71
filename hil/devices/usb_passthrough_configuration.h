// A real USB device of this machine that the rig passes on.
#pragma once

#include <stdexcept>
#include <string>

#include "drivers/usb_selector.h"
#include "hil/configuration/fields.h"

namespace rigwire::hil {

struct UsbPassThroughConfiguration {
  std::string device;  ///< See drivers/usb_selector.h.
};

template <class Visitor>
void visit(Visitor& v, UsbPassThroughConfiguration& p) {
  v.required("device");
  v.text("device", p.device,
         "vendor:product, vendor:product:serial number, or the place where it is plugged in "
         "(1-1.4).");
}

inline void validate(const UsbPassThroughConfiguration& p) {
  static_cast<void>(drivers::parse_usb_selector(p.device));
}

}  // namespace rigwire::hil
