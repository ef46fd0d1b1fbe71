// The USB/IP server of a rig, and what can happen to the plugs of its devices.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/fault_window.h"
#include "protocols/usbip/constants.h"
#include "sim/samples/fault_book.h"

namespace rigwire::hil {

/// One server for all USB devices of a rig; it is started when there is one.
struct UsbConfiguration {
  std::string address = "127.0.0.1";  ///< Numeric IPv4.
  std::uint16_t port = protocols::usbip::kPort;
  bool allow_remote = false;
};

/// While the device is pulled out.
inline void append_unplugged(std::vector<FaultWindow>& windows,
                             const std::vector<FaultPeriod>& unplugged, std::string_view where) {
  for (const FaultPeriod& period : unplugged) {
    windows.push_back({std::string(where), "unplugged", period.begin(), period.end()});
  }
}

inline void visit(fields::Visitor& v, UsbConfiguration& p) {
  v.text("address", p.address, "Where clients attach (usbip attach -r).");
  v.integer("port", p.port, fields::IntegerRule{1, 65535}, "TCP.");
  v.boolean("allow_remote", p.allow_remote, "Opt-in for addresses beyond this machine.");
}

}  // namespace rigwire::hil
