#include "hil/command_line/usb_doctor.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>

#include "drivers/usb_host.h"
#include "drivers/vhci.h"

namespace rigwire::hil {

namespace {

namespace fs = std::filesystem;

Finding usbip_client() {
  const std::string obstacle = drivers::vhci_obstacle();
  if (obstacle.empty()) {
    return {"USB/IP", Health::good, "emulated USB devices can be attached to this kernel", ""};
  }
  const auto split = obstacle.find("; ");
  return {"USB/IP", Health::limited,
          obstacle.substr(0, split) + ": emulated USB devices are served, for other machines",
          obstacle.substr(split + 2)};
}

/// Loaded, or there to be loaded.
bool has_module(const std::string& name) {
  std::error_code ignored;
  if (fs::exists("/sys/module/" + name, ignored)) {
    return true;
  }
  utsname system{};
  ::uname(&system);
  const fs::path folder = fs::path("/lib/modules") / system.release / "kernel/drivers/net/can/usb";
  for (const char* suffix : {".ko", ".ko.xz", ".ko.zst", ".ko.gz"}) {
    if (fs::exists(folder / (name + suffix), ignored)) {
      return true;
    }
  }
  return false;
}

Finding gs_usb_driver() {
  if (has_module("gs_usb")) {
    return {"gs_usb", Health::good, "the kernel makes CAN interfaces of USB adapters", ""};
  }
  return {"gs_usb", Health::limited, "the kernel has no driver for USB to CAN adapters",
          "a kernel with CONFIG_CAN_GS_USB, as Debian's linux-image-amd64 (not the cloud one)"};
}

Finding usbip_program() {
  for (const char* path : {"/usr/sbin/usbip", "/usr/bin/usbip", "/sbin/usbip"}) {
    if (::access(path, X_OK) == 0) {
      return {"usbip", Health::good, std::string(path) + " attaches devices by hand", ""};
    }
  }
  return {"usbip", Health::limited, "no program `usbip`", "sudo apt-get install usbip"};
}

Finding usb_devices() {
  try {
    std::string text;
    for (const drivers::UsbListed& device : drivers::list_usb_devices()) {
      text += fmt::format("{}{} {:04x}:{:04x}{}{}{}", text.empty() ? "" : ", ", device.place,
                          device.vendor, device.product, device.product_name.empty() ? "" : " ",
                          device.product_name, device.permitted ? "" : " (not permitted)");
    }
    return {"USB devices", Health::good, text.empty() ? "none" : text, ""};
  } catch (const drivers::EndpointError& error) {
    return {"USB devices", Health::limited, error.what(), "mount /dev and /sys"};
  }
}

}  // namespace

std::vector<Finding> examine_usb() {
  return {usbip_client(), gs_usb_driver(), usbip_program(), usb_devices()};
}

}  // namespace rigwire::hil
