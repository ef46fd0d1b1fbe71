// A real USB device of this machine as a device of the rig: opened by libusb, exported by the rig's
// USB bus.
#include <memory>
#include <string>

#include "drivers/usb_host.h"
#include "fields/visitor.h"
#include "hil/devices/device.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/device_types.h"
#include "hil/devices/rig_check.h"
#include "hil/devices/site.h"
#include "hil/wires/usb_passthrough.h"

namespace rigwire::hil {
namespace {

/// Nothing of it is emulated.
class PassedOn final : public emulators::Device {
 public:
  void advance(SimTime /*now*/) override {}
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
};

class UsbPassThroughDevice final : public Device {
 public:
  UsbPassThroughDevice(const std::string& device, Site& site)
      : bus_(site.usb()),
        host_(site.io()),
        real_(host_.open(drivers::parse_usb_selector(device))),
        socket_(bus_.plug(real_, site.name())) {}

  // The bus lets the device live; there is nothing to be routed to it, so that it is no station.
  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return {bus_.address(socket_) + " for " + real_.device().address(), bus_.imported(socket_)};
  }
  [[nodiscard]] const emulators::Device& emulator() const override { return nothing_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return client_request(real_.last_request());
  }

 private:
  UsbBus& bus_;
  drivers::UsbHost host_;
  UsbPassThrough real_;
  UsbBus::Socket socket_;
  PassedOn nothing_;
};

/// A real USB device of this machine as a device of the rig: opened by libusb, exported by the
/// rig's USB/IP server.
struct UsbPassThroughConfiguration final : DeviceConfigurationOf<UsbPassThroughConfiguration> {
  std::string device;  ///< Text of a UsbSelector (drivers/usb_host.h).

  void visit(fields::Visitor& v) override {
    v.required("device");
    v.text("device", device,
           "vendor:product, vendor:product:serial number, or the place where it is plugged in "
           "(1-1.4).");
  }

  void validate() const override { static_cast<void>(drivers::parse_usb_selector(device)); }

  void check(const std::string& at, RigCheck& check) const override {
    check.usb();
    check.claim(at + ".device", "USB device " + device, device);
  }

  void each_fault(const FaultEar& /*take*/) override {}
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override { return {}; }

  [[nodiscard]] DevicePlan plan(const RigView& rig) const override {
    return {usb_wire(rig), "as it does", "", "the real " + device};
  }

  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view /*name*/) const override {
    return std::nullopt;
  }

  [[nodiscard]] DeviceDescription describe() const override {
    DeviceDescription description;
    description.wire = "USB as the real device's, by USB/IP, default 127.0.0.1:3240";
    description.document = "the real device; Universal Serial Bus 2.0";
    description.page = "docs/usb.md";
    description.messages = {{"transfers", "as it does", "control, bulk, interrupt"}};
    return description;
  }

  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override {
    return std::make_unique<UsbPassThroughDevice>(device, site);
  }
};

}  // namespace

std::unique_ptr<DeviceConfiguration> fresh_usb_passthrough() {
  return std::make_unique<UsbPassThroughConfiguration>();
}

}  // namespace rigwire::hil
