#include "emulators/usb/usb_port.h"

#include <algorithm>

namespace rigwire::emulators {

using protocols::usb::kToHost;
using protocols::usb::Outcome;
using protocols::usb::Setup;

void complete_to(UsbHost& host, SimTime now, UsbTransfer transfer, const Setup& setup,
                 std::span<const std::uint8_t> answer) {
  host.complete(now, transfer, Outcome::done,
                answer.first(std::min<std::size_t>(answer.size(), setup.length)), 0);
}

void UsbPort::attach(SimTime now, UsbHost& host) {
  standard_.reset();
  host_ = &host;
  device_.plugged(now, host);
}

void UsbPort::detach(SimTime now) {
  host_ = nullptr;
  standard_.reset();
  device_.unplugged(now);
}

void UsbPort::control(SimTime now, UsbTransfer transfer, const Setup& setup,
                      std::span<const std::uint8_t> data) {
  if (const auto answer = standard_.answer(now, setup)) {
    host_->complete(now, transfer, answer->outcome, answer->data, 0);
  } else {
    device_.control(now, transfer, setup, data);
  }
}

void UsbPort::read(SimTime now, UsbTransfer transfer, std::uint8_t endpoint, std::size_t length) {
  if (usable(endpoint) && (endpoint & kToHost) != 0) {
    device_.read(now, transfer, endpoint, length);
  } else {
    stall(now, transfer);
  }
}

void UsbPort::write(SimTime now, UsbTransfer transfer, std::uint8_t endpoint,
                    std::span<const std::uint8_t> data) {
  if (usable(endpoint) && (endpoint & kToHost) == 0) {
    device_.write(now, transfer, endpoint, data);
  } else {
    stall(now, transfer);
  }
}

bool UsbPort::usable(std::uint8_t endpoint) const {
  return standard_.endpoint(endpoint) != nullptr && !standard_.halted(endpoint);
}

void UsbPort::stall(SimTime now, UsbTransfer transfer) {
  host_->complete(now, transfer, Outcome::stalled, {}, 0);
}

}  // namespace rigwire::emulators
