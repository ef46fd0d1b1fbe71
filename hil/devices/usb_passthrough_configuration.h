// A real USB device of this machine that the rig passes on.
#pragma once

#include <stdexcept>
#include <string>

#include "drivers/usb_selector.h"
#include "fields/visitor.h"

namespace rigwire::hil {

struct UsbPassThroughConfiguration {
  static constexpr fields::Named kNamed{
      "usb-passthrough", "A real USB device of this machine, passed on by the rig's USB bus."};

  std::string device;  ///< See drivers/usb_selector.h.
};

inline void visit(fields::Visitor& v, UsbPassThroughConfiguration& p) {
  v.required("device");
  v.text("device", p.device,
         "vendor:product, vendor:product:serial number, or the place where it is plugged in "
         "(1-1.4).");
}

inline void validate(const UsbPassThroughConfiguration& p) {
  static_cast<void>(drivers::parse_usb_selector(p.device));
}

}  // namespace rigwire::hil
