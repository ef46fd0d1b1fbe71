// The USB/IP server of a rig, and what can happen to the plugs of its devices.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/fault_window.h"
#include "protocols/usbip/constants.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// One server for all USB devices of a rig; it is started when there is one.
struct UsbConfiguration {
  std::string address = "127.0.0.1";  ///< Numeric IPv4.
  std::uint16_t port = protocols::usbip::kPort;
  bool allow_remote = false;
};

/// The device is pulled out and put back.
struct UnplugConfiguration {
  Duration at{0};  ///< From the start of the run.
  Duration length = std::chrono::seconds{10};
};

inline void append_unplugged(std::vector<FaultWindow>& windows,
                             const std::vector<UnplugConfiguration>& unplugged,
                             std::string_view where) {
  for (const UnplugConfiguration& unplug : unplugged) {
    windows.push_back(
        {std::string(where), "unplugged", kStart + unplug.at, kStart + unplug.at + unplug.length});
  }
}

inline void visit(fields::Visitor& v, UsbConfiguration& p) {
  v.text("address", p.address, "Where clients attach (usbip attach -r).");
  v.integer("port", p.port, fields::IntegerRule{1, 65535}, "TCP.");
  v.boolean("allow_remote", p.allow_remote, "Opt-in for addresses beyond this machine.");
}

inline void visit(fields::Visitor& v, UnplugConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns},
             "Instant at which it begins, from the start of the run.");
  v.duration("for", p.length, {1'000'000, fields::kYear_ns}, "How long the plug is out.");
}

}  // namespace rigwire::hil
