#include "emulators/usb/gs_usb.h"

#include <algorithm>
#include <stdexcept>

namespace rigwire::emulators {

namespace gs_usb = protocols::gs_usb;
namespace usb = protocols::usb;

namespace {

/// candleLight's, with one CAN channel and the entry to its firmware upgrade.
usb::DeviceDescription describe(const GsUsbSettings& settings) {
  usb::InterfaceDescription channel;
  channel.number = 0;
  channel.device_class = 0xFF;
  channel.subclass = 0xFF;
  channel.protocol = 0xFF;
  channel.endpoints = {
      {gs_usb::kEndpointToHost, usb::TransferType::bulk, gs_usb::kPacketBytes, 0},
      {gs_usb::kEndpointToDevice, usb::TransferType::bulk, gs_usb::kPacketBytes, 0}};

  usb::InterfaceDescription upgrade;
  upgrade.number = 1;
  upgrade.device_class = 0xFE;  // application specific
  upgrade.subclass = 0x01;      // device firmware upgrade
  upgrade.protocol = 0x01;      // run time
  upgrade.text = "candleLight firmware upgrade interface";
  // USB DFU 1.1, table 4.2: can download and upload, will detach; 255 ms; 2048 bytes; version 1.1a.
  upgrade.extra = {9, 0x21, 0x0B, 0xFF, 0x00, 0x00, 0x08, 0x1A, 0x01};

  usb::DeviceDescription device;
  device.vendor = 0x1D50;
  device.product = 0x606F;
  device.release = 0x0000;
  device.manufacturer = "bytewerk";
  device.product_name = "candleLight USB to CAN adapter";
  device.serial_number = settings.serial_number;
  device.maximum_power_2ma = 75;
  device.interfaces = {channel, upgrade};
  return device;
}

}  // namespace

void validate(const GsUsbSettings& settings) {
  const auto is_digit = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'F') || (c >= 'a' && c <= 'f');
  };
  if (settings.serial_number.size() != 24 ||
      !std::ranges::all_of(settings.serial_number, is_digit)) {
    throw std::invalid_argument("gs_usb adapter: serial number '" + settings.serial_number +
                                "'; 24 hexadecimal digits are allowed");
  }
  if (settings.memory_frames < 16 || settings.memory_frames > GsUsbAdapter::kMemoryMax) {
    throw std::invalid_argument("gs_usb adapter: memory of " +
                                std::to_string(settings.memory_frames) +
                                " frames; 16 .. 1024 are allowed");
  }
}

GsUsbAdapter::GsUsbAdapter(const GsUsbSettings& settings, GsUsbWire& wire)
    : memory_frames_(settings.memory_frames), wire_(wire) {
  validate(settings);
  description_ = describe(settings);
  controller_.present = false;
}

void GsUsbAdapter::plugged(SimTime now, UsbHost& host) {
  unplugged(now);
  host_ = &host;
}

void GsUsbAdapter::unplugged(SimTime now) {
  host_ = nullptr;
  reads_.clear();
  writes_.clear();
  stop(now);
  bit_rate_bps_.reset();
  identifying_ = false;
}

bool GsUsbAdapter::cancel(SimTime /*now*/, UsbTransfer transfer) {
  const auto is_it = [transfer](const auto& open) { return open.transfer == transfer; };
  return reads_.remove_first(is_it) || writes_.remove_first(is_it);
}

SimTime GsUsbAdapter::next_event() const {
  return std::min(restart_at_, loop_end_);
}

void GsUsbAdapter::advance(SimTime now) {
  while (next_event() <= now) {
    if (loop_end_ <= restart_at_) {
      end_loop();
    } else {
      restart(restart_at_);
    }
  }
}

}  // namespace rigwire::emulators
