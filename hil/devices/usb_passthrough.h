// A real USB device of this machine as a device of the rig: opened by libusb, exported by the rig's
// USB bus.
#pragma once

#include <memory>
#include <string>

#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

struct UsbPassThroughConfiguration final : DeviceConfigurationOf<UsbPassThroughConfiguration> {
  std::string device;  ///< See drivers/usb_selector.h.

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  [[nodiscard]] std::vector<FaultWindow> fault_windows(std::string_view name) const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
};

}  // namespace rigwire::hil
