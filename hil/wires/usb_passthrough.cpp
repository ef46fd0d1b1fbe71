#include "hil/wires/usb_passthrough.h"

#include <algorithm>

namespace rigwire::hil {

using protocols::usb::TransferType;

namespace {

/// What can be passed on: bulk and interrupt endpoints.
protocols::usb::DeviceDescription without_isochronous(protocols::usb::DeviceDescription device) {
  for (auto& interface : device.interfaces) {
    std::erase_if(interface.endpoints,
                  [](const auto& endpoint) { return endpoint.type == TransferType::isochronous; });
  }
  return device;
}

}  // namespace

UsbPassThrough::UsbPassThrough(std::unique_ptr<drivers::UsbDeviceHandle> device)
    : device_(std::move(device)), description_(without_isochronous(device_->description())) {
  for (const auto& interface : description_.interfaces) {
    if (interface.alternate == 0) {
      device_->claim(interface.number);
    }
  }
}

UsbPassThrough::~UsbPassThrough() = default;

void UsbPassThrough::plugged(SimTime now, emulators::UsbHost& host) {
  unplugged(now);
  host_ = &host;
}

void UsbPassThrough::unplugged(SimTime now) {
  now_ = now;
  host_ = nullptr;
  ++client_;
  for (const auto& [transfer, on_device] : open_) {
    device_->cancel(on_device);
  }
  open_.clear();
}

drivers::UsbDeviceHandle::Done UsbPassThrough::passing_on(emulators::UsbTransfer transfer,
                                                          std::uint8_t endpoint) {
  return
      [this, transfer, endpoint, client = client_](const drivers::UsbDeviceHandle::Result& result) {
        if (result.outcome == Outcome::stalled && endpoint != 0) {
          device_->clear_halt(endpoint);
        }
        if (client == client_ && open_.erase(transfer) != 0) {
          host_->complete(now_, transfer, result.outcome, result.data, result.taken);
        }
      };
}

void UsbPassThrough::control(SimTime now, emulators::UsbTransfer transfer,
                             const protocols::usb::Setup& setup,
                             std::span<const std::uint8_t> data) {
  now_ = now;
  last_request_ = {now, setup};
  open_[transfer] = device_->control(setup, data, passing_on(transfer, 0));
}

void UsbPassThrough::read(SimTime now, emulators::UsbTransfer transfer, std::uint8_t endpoint,
                          std::size_t length) {
  now_ = now;
  open_[transfer] = device_->read(endpoint, length, passing_on(transfer, endpoint));
}

void UsbPassThrough::write(SimTime now, emulators::UsbTransfer transfer, std::uint8_t endpoint,
                           std::span<const std::uint8_t> data) {
  now_ = now;
  open_[transfer] = device_->write(endpoint, data, passing_on(transfer, endpoint));
}

bool UsbPassThrough::cancel(SimTime now, emulators::UsbTransfer transfer) {
  now_ = now;
  const auto found = open_.find(transfer);
  if (found == open_.end()) {
    return false;
  }
  device_->cancel(found->second);
  open_.erase(found);
  return true;
}

}  // namespace rigwire::hil
