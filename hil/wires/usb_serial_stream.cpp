#include "hil/wires/usb_serial_stream.h"

#include <algorithm>
#include <boost/asio/post.hpp>

namespace rigwire::hil {

UsbSerialStream::UsbSerialStream(boost::asio::io_context& io, UsbBus& bus,
                                 const emulators::CdcAcmSettings& settings, std::string_view name)
    : io_(io), bus_(bus), usb_(settings, *this), socket_(bus.plug(usb_, name)) {}

UsbSerialStream::~UsbSerialStream() = default;

void UsbSerialStream::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  call_later();
}

std::size_t UsbSerialStream::write(std::span<const std::uint8_t> bytes) {
  return usb_.send(bus_.now(), bytes) ? bytes.size() : 0;
}

drivers::EndpointStatus UsbSerialStream::status() const {
  return {bus_.address(socket_), usb_.line().client_present};
}

void UsbSerialStream::received(SimTime /*now*/, std::span<const std::uint8_t> bytes) {
  const std::size_t room = kUnreadMaximum - std::min(kUnreadMaximum, unread_.size());
  const auto taken = bytes.first(std::min(room, bytes.size()));
  unread_.insert(unread_.end(), taken.begin(), taken.end());
  call_later();
}

void UsbSerialStream::line_changed(SimTime /*now*/, const emulators::CdcAcmLine& /*line*/) {
  call_later();
}

void UsbSerialStream::call_later() {
  if (call_pending_ || !receiver_) {
    return;
  }
  call_pending_ = true;
  boost::asio::post(io_, [this, alive = std::weak_ptr<char>(alive_)] {
    if (!alive.expired()) {
      hand_on();
    }
  });
}

void UsbSerialStream::hand_on() {
  call_pending_ = false;
  if (!unread_.empty()) {
    tell(true);  // The client that wrote was present, even if it has gone by now.
    std::swap(unread_, handing_on_);
    receiver_(handing_on_);
    handing_on_.clear();
  }
  tell(usb_.line().client_present);
}

void UsbSerialStream::tell(bool present) {
  if (present != told_present_) {
    told_present_ = present;
    if (watcher_) {
      watcher_({present, 0});
    }
  }
}

}  // namespace rigwire::hil
