#include "hil/wires/gs_usb_can.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace rigwire::hil {

namespace {

struct TcpAddress {
  std::string host;
  std::uint16_t port = 0;
  std::string bus_id;
};

/// "usb 127.0.0.1:3240 1-1"
std::optional<TcpAddress> parse(std::string_view address) {
  constexpr std::string_view kBegin = "usb ";
  const auto blank = address.rfind(' ');
  const auto colon = address.rfind(':', blank);
  if (!address.starts_with(kBegin) || colon == std::string_view::npos || blank < colon) {
    return std::nullopt;
  }
  TcpAddress parsed;
  parsed.host = address.substr(kBegin.size(), colon - kBegin.size());
  parsed.bus_id = address.substr(blank + 1);
  const char* const end = address.data() + blank;
  const auto [stopped, error] = std::from_chars(address.data() + colon + 1, end, parsed.port);
  return error == std::errc{} && stopped == end ? std::optional(parsed) : std::nullopt;
}

}  // namespace

std::string gs_usb_obstacle() {
  return drivers::vhci_obstacle();
}

GsUsbCan::GsUsbCan(boost::asio::io_context& io, UsbBus& usb_bus, const GsUsbCanSettings& settings)
    : io_(io),
      usb_bus_(usb_bus),
      attach_(settings.attach),
      adapter_(settings.adapter, *this),
      socket_(usb_bus.plug(adapter_, settings.name)) {}

GsUsbCan::~GsUsbCan() = default;

void GsUsbCan::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  if (!attach_) {
    return;
  }
  const auto address = parse(usb_bus_.address(socket_));
  if (!address) {
    attach_error_ = "USB bus " + usb_bus_.address(socket_) + " is no TCP server";
    return;
  }
  attachment_ = std::make_unique<drivers::VhciAttachment>(
      io_, address->host, address->port, address->bus_id,
      [this](const std::string& error) { attach_error_ = error; });
}

bool GsUsbCan::deliver(const protocols::can::Frame& frame, Stamp stamp) {
  return adapter_.received(reached(stamp), frame);
}

void GsUsbCan::confirm(bool sent, Stamp stamp) {
  adapter_.confirmed(reached(stamp), sent);
}

bool GsUsbCan::report(const protocols::can::ControllerReport& report, Stamp stamp) {
  return adapter_.reported(reached(stamp), report);
}

drivers::EndpointStatus GsUsbCan::status() const {
  std::string address = "gs_usb on " + usb_bus_.address(socket_);
  if (!attach_error_.empty()) {
    address += " (not attached: " + attach_error_ + ")";
  }
  return {std::move(address), adapter_.controller().present};
}

void GsUsbCan::set_controller(SimTime /*now*/, const emulators::OutsideController& controller) {
  if (watcher_) {
    watcher_({.open = controller.present,
              .bit_rate_bps = controller.present ? controller.bit_rate_bps : 0,
              .listen_only = controller.listen_only,
              .one_shot = controller.one_shot});
  }
}

void GsUsbCan::send(SimTime /*now*/, const protocols::can::Frame& frame) {
  if (receiver_) {
    receiver_(frame);
  }
}

SimTime GsUsbCan::reached(Stamp stamp) {
  latest_ = std::max(latest_, stamp);
  return kStart + stamp;
}

}  // namespace rigwire::hil
