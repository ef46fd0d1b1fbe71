// A USB device for tests: it records what reaches it and does what the test says.
#pragma once

#include <algorithm>
#include <vector>

#include "emulators/usb/usb_port.h"

namespace rigwire::emulators {

/// Interface 0 has an interrupt IN endpoint 0x81 and, in alternate setting 1, none; interface 1 has
/// bulk OUT 0x02 and bulk IN 0x82. Vendor request 1 to the host gives five bytes, vendor request 2
/// to the device takes its data, others stall. Bulk writes are done at once; reads stay open until
/// answer().
class UsbProbe final : public UsbDevice {
 public:
  struct Read {
    UsbTransfer transfer = 0;
    std::uint8_t endpoint = 0;
    std::size_t length = 0;
  };

  explicit UsbProbe(std::uint16_t product = 1) {
    description_.vendor = 0x1209;
    description_.product = product;
    description_.manufacturer = "Test";
    description_.self_powered = true;
    protocols::usb::InterfaceDescription first;
    first.device_class = 0xFF;
    first.endpoints.push_back({0x81, protocols::usb::TransferType::interrupt, 8, 10});
    protocols::usb::InterfaceDescription other = first;
    other.alternate = 1;
    other.endpoints.clear();
    protocols::usb::InterfaceDescription second;
    second.number = 1;
    second.endpoints.push_back({0x02, protocols::usb::TransferType::bulk, 64, 0});
    second.endpoints.push_back({0x82, protocols::usb::TransferType::bulk, 64, 0});
    description_.interfaces = {first, other, second};
  }

  const protocols::usb::DeviceDescription& description() const override { return description_; }
  void plugged(SimTime /*now*/, UsbHost& host) override {
    host_ = &host;
    ++times_plugged;
  }
  void unplugged(SimTime /*now*/) override {
    host_ = nullptr;
    reads.clear();
    ++times_unplugged;
  }
  void configured(SimTime /*now*/, std::uint8_t configuration) override {
    configurations.push_back(configuration);
  }
  void selected(SimTime /*now*/, std::uint8_t interface, std::uint8_t alternate) override {
    selections.emplace_back(interface, alternate);
  }
  void control(SimTime now, UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data) override {
    setups.push_back(setup);
    if (setup.request_type == 0xC0 && setup.request == 1) {
      complete_to(*host_, now, transfer, setup, std::vector<std::uint8_t>{1, 2, 3, 4, 5});
    } else if (setup.request_type == 0x40 && setup.request == 2) {
      written.assign(data.begin(), data.end());
      host_->complete(now, transfer, protocols::usb::Outcome::done, {}, data.size());
    } else {
      host_->complete(now, transfer, protocols::usb::Outcome::stalled, {}, 0);
    }
  }
  void read(SimTime /*now*/, UsbTransfer transfer, std::uint8_t endpoint,
            std::size_t length) override {
    reads.push_back({transfer, endpoint, length});
  }
  void write(SimTime now, UsbTransfer transfer, std::uint8_t /*endpoint*/,
             std::span<const std::uint8_t> data) override {
    written.assign(data.begin(), data.end());
    host_->complete(now, transfer, protocols::usb::Outcome::done, {}, data.size());
  }
  bool cancel(SimTime /*now*/, UsbTransfer transfer) override {
    return std::erase_if(reads, [&](const Read& r) { return r.transfer == transfer; }) == 1;
  }

  /// Ends the oldest open read.
  void answer(SimTime now, const std::vector<std::uint8_t>& data) {
    const Read read = reads.front();
    reads.erase(reads.begin());
    host_->complete(now, read.transfer, protocols::usb::Outcome::done, data, 0);
  }

  int times_plugged = 0;
  int times_unplugged = 0;
  std::vector<std::uint8_t> configurations;
  std::vector<std::pair<std::uint8_t, std::uint8_t>> selections;
  std::vector<protocols::usb::Setup> setups;
  std::vector<std::uint8_t> written;
  std::vector<Read> reads;

 private:
  protocols::usb::DeviceDescription description_;
  UsbHost* host_ = nullptr;
};

/// A host for one device without USB/IP between them.
class DirectHost final : public UsbHost {
 public:
  struct End {
    UsbTransfer transfer = 0;
    protocols::usb::Outcome outcome{};
    std::vector<std::uint8_t> data;
    std::size_t taken = 0;
  };

  explicit DirectHost(UsbDevice& device) : port(device) { port.attach(kStart, *this); }

  void complete(SimTime now, UsbTransfer transfer, protocols::usb::Outcome outcome,
                std::span<const std::uint8_t> data, std::size_t taken) override {
    ends.push_back({transfer, outcome, {data.begin(), data.end()}, taken});
    last_end = now;
  }

  /// Sends a control request and gives its end, which must come at once.
  End control(const protocols::usb::Setup& setup, const std::vector<std::uint8_t>& data = {},
              SimTime now = kStart) {
    port.control(now, ++number, setup, data);
    End end = ends.back();
    ends.pop_back();
    return end;
  }
  UsbTransfer read(std::uint8_t endpoint, std::size_t length, SimTime now = kStart) {
    port.read(now, ++number, endpoint, length);
    return number;
  }
  UsbTransfer write(std::uint8_t endpoint, const std::vector<std::uint8_t>& data,
                    SimTime now = kStart) {
    port.write(now, ++number, endpoint, data);
    return number;
  }
  void configure() {
    port.control(kStart, ++number, {0x00, 9, port.device().description().configuration_value, 0, 0},
                 {});
    ends.pop_back();
  }

  UsbPort port;
  std::vector<End> ends;
  SimTime last_end{};
  UsbTransfer number = 0;
};

}  // namespace rigwire::emulators
