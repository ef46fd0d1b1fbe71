#include "hil/devices/bus_devices.h"

#include <variant>

#include "hil/devices/frame_rate.h"

namespace rigwire::hil {

std::string bus_of(const DeviceConfiguration& device) {
  return std::visit(
      [](const auto& settings) -> std::string {
        if constexpr (requires { settings.bus; }) {
          return settings.bus;
        } else {
          return {};
        }
      },
      device.settings);
}

std::vector<std::string> devices_on(const RigConfiguration& rig, const std::string& bus) {
  std::vector<std::string> names;
  for (const auto& [name, device] : rig.devices) {
    if (bus_of(device) == bus) {
      names.push_back(name);
    }
  }
  return names;
}

double frame_rate_on(const std::string& bus, const DeviceConfiguration& device) {
  if (bus_of(device) != bus) {
    return 0.0;
  }
  return std::visit(
      [](const auto& settings) {
        if constexpr (requires { frame_rate_hz(settings); }) {
          return frame_rate_hz(settings);
        } else {
          return 0.0;
        }
      },
      device.settings);
}

}  // namespace rigwire::hil
