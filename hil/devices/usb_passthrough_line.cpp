#include "hil/devices/usb_passthrough_line.h"

#include "drivers/usb_host.h"
#include "hil/devices/usb_passthrough.h"

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

class UsbPassThroughLine final : public DeviceLine {
 public:
  UsbPassThroughLine(const UsbPassThroughConfiguration& configuration, boost::asio::io_context& io,
                     UsbBus& bus, std::string_view name)
      : host_(io),
        real_(host_.open(drivers::parse_usb_selector(configuration.device))),
        bus_(bus),
        socket_(bus.plug(real_, name)) {}

  /// The bus lets the device live; there is nothing to be routed to it, so that it is no station.
  DeviceIndex enlist(Executive& /*executive*/) override { return {}; }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override {
    return {bus_.address(socket_) + " for " + real_.device().address(), bus_.imported(socket_)};
  }
  [[nodiscard]] const emulators::Device& device() const override { return device_; }

 private:
  drivers::UsbHost host_;
  UsbPassThrough real_;
  UsbBus& bus_;
  UsbBus::Socket socket_;
  PassedOn device_;
};

}  // namespace

std::unique_ptr<DeviceLine> make_line(const UsbPassThroughConfiguration& configuration,
                                      boost::asio::io_context& io, UsbBus& bus,
                                      std::string_view name) {
  return std::make_unique<UsbPassThroughLine>(configuration, io, bus, name);
}

}  // namespace rigwire::hil
