// The last hop of a CAN bus as a USB adapter: an emulated gs_usb device on the rig's USB bus, which
// a client's kernel turns into a canX.
//
// What the client does to its interface (`ip link set canX type can bitrate 250000`, up, down)
// reaches the bus model by on_client(); what happens on the bus reaches the interface: frames with
// their time stamps, echoes when a frame has been sent, states and bus-off.
//
// With `attach` the rig attaches the device to this machine's kernel itself, which takes root and
// the module vhci-hcd; else `status()` names the address for `usbip attach`.
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "drivers/endpoints.h"
#include "drivers/vhci.h"
#include "emulators/usb/gs_usb.h"
#include "hil/wires/usb_bus.h"

namespace rigwire::hil {

/// Why no adapter can be attached to this machine's kernel, with the mend; empty: it can.
[[nodiscard]] std::string gs_usb_obstacle();

struct GsUsbCanSettings {
  std::string name = "can";  ///< Name of the device in the USB bus's list.
  emulators::GsUsbSettings adapter{.memory_frames = emulators::GsUsbAdapter::kMemoryMax};
  bool attach = false;  ///< To this machine's kernel.
};

class GsUsbCan final : public drivers::CanBus, private emulators::GsUsbWire {
 public:
  /// Plugs the adapter into `usb_bus`, which the endpoint must outlive, as every device on it; the
  /// endpoint is of use as long as the bus is there. Throws std::invalid_argument.
  GsUsbCan(boost::asio::io_context& io, UsbBus& usb_bus, const GsUsbCanSettings& settings);
  ~GsUsbCan() override;
  GsUsbCan(const GsUsbCan&) = delete;
  GsUsbCan& operator=(const GsUsbCan&) = delete;

  void start(Receiver receiver) override;
  void on_client(ClientWatcher watcher) override { watcher_ = std::move(watcher); }
  /// With the time of the frame before: deliver() knows better.
  bool send(const protocols::can::Frame& frame) override { return deliver(frame, latest_); }
  /// False when the client does not read and the adapter's memory is full.
  bool deliver(const protocols::can::Frame& frame, Stamp stamp) override;
  void confirm(bool sent, Stamp stamp) override;
  bool report(const protocols::can::ControllerReport& report, Stamp stamp) override;
  /// "gs_usb on usb 127.0.0.1:3240 1-1", with attach_error(); client_present: the interface is up.
  [[nodiscard]] drivers::EndpointStatus status() const override;

  [[nodiscard]] const emulators::GsUsbAdapter& adapter() const { return adapter_; }
  [[nodiscard]] UsbBus::Socket socket() const { return socket_; }
  /// Why attaching failed; empty while it has not.
  [[nodiscard]] const std::string& attach_error() const { return attach_error_; }

 private:
  void set_controller(SimTime now, const emulators::OutsideController& controller) override;
  void send(SimTime now, const protocols::can::Frame& frame) override;
  [[nodiscard]] SimTime reached(Stamp stamp);

  boost::asio::io_context& io_;
  UsbBus& usb_bus_;
  bool attach_;
  emulators::GsUsbAdapter adapter_;
  UsbBus::Socket socket_;
  Receiver receiver_;
  ClientWatcher watcher_;
  Stamp latest_{0};
  std::unique_ptr<drivers::VhciAttachment> attachment_;
  std::string attach_error_;
};

}  // namespace rigwire::hil
