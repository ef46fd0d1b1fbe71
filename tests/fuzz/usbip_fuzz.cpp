// USB/IP on any bytes: the decoders take no more than they were given and survive a round trip; a
// server with two devices survives a hostile client, whose connection may end at any byte.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "emulators/usb/usbip_server.h"
#include "protocols/usbip/commands.h"
#include "protocols/usbip/operations.h"

namespace {

using namespace rigwire;
using namespace rigwire::protocols::usbip;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

template <class T>
void check_consumed(const protocols::Decoded<T>& decoded, std::span<const std::uint8_t> bytes) {
  require(decoded.consumed() <= bytes.size());
  require(!decoded.incomplete() || decoded.shortage().needed > bytes.size());
}

void check_decoders(std::span<const std::uint8_t> bytes) {
  const auto request = decode_request(bytes);
  check_consumed(request, bytes);
  if (request.ok()) {
    require(*decode_request(encode_request(*request)) == *request);
  }
  const auto command = decode_from_host(bytes);
  check_consumed(command, bytes);
  if (command.ok()) {
    if (const auto* submit = std::get_if<Submit>(&*command)) {
      require(submit->tail_size() <= kDataMaximum + kPacketsMaximum * kIsochronousRecordSize);
    }
    const auto again = std::visit([](const auto& c) { return encode(c); }, *command);
    require(*decode_from_host(again) == *command);
  }
  const auto list = decode_device_list(bytes);
  check_consumed(list, bytes);
  if (list.ok()) {
    for (const ListedDevice& listed : *list) {
      require(listed.device.path.size() <= kPathSize);
      require(listed.interfaces.size() == listed.device.interfaces);
    }
  }
  check_consumed(decode_import_reply(bytes), bytes);
  check_consumed(decode_from_device(bytes), bytes);
}

/// Echoes bulk writes into bulk reads, answers vendor requests, keeps reads open.
class Echo final : public emulators::UsbDevice {
 public:
  Echo() {
    protocols::usb::InterfaceDescription interface;
    interface.endpoints = {{0x02, protocols::usb::TransferType::bulk, 64, 0},
                           {0x82, protocols::usb::TransferType::bulk, 64, 0}};
    description_.interfaces.push_back(interface);
  }
  const protocols::usb::DeviceDescription& description() const override { return description_; }
  void plugged(SimTime /*now*/, emulators::UsbHost& host) override { host_ = &host; }
  void unplugged(SimTime /*now*/) override { reads_.clear(); }
  void control(SimTime now, emulators::UsbTransfer transfer, const protocols::usb::Setup& setup,
               std::span<const std::uint8_t> data) override {
    require(setup.to_host() ? data.empty() : data.size() == setup.length);
    emulators::complete_to(*host_, now, transfer, setup.to_host() ? setup : protocols::usb::Setup{},
                           answer_);
  }
  void read(SimTime /*now*/, emulators::UsbTransfer transfer, std::uint8_t /*endpoint*/,
            std::size_t length) override {
    reads_.push_back({transfer, length});
  }
  void write(SimTime now, emulators::UsbTransfer transfer, std::uint8_t /*endpoint*/,
             std::span<const std::uint8_t> data) override {
    host_->complete(now, transfer, protocols::usb::Outcome::done, {}, data.size());
    if (!reads_.empty()) {
      const auto [open, length] = reads_.back();
      reads_.pop_back();
      host_->complete(now, open, protocols::usb::Outcome::done,
                      data.first(std::min(data.size(), length)), 0);
    }
  }
  bool cancel(SimTime /*now*/, emulators::UsbTransfer transfer) override {
    return std::erase_if(reads_, [&](const auto& r) { return r.first == transfer; }) == 1;
  }

 private:
  protocols::usb::DeviceDescription description_;
  emulators::UsbHost* host_ = nullptr;
  std::vector<std::pair<emulators::UsbTransfer, std::size_t>> reads_;
  std::array<std::uint8_t, 40> answer_{};
};

class Sink final : public emulators::StreamOutput {
 public:
  void send(emulators::ConnectionId /*connection*/, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    require(!closed && !bytes.empty());
  }
  void close(emulators::ConnectionId /*connection*/, SimTime /*due*/) override { closed = true; }
  bool closed = false;
};

/// One client with everything in one piece, and one that gets it in small pieces.
void check_server(std::span<const std::uint8_t> bytes) {
  for (const std::size_t piece : {bytes.size(), std::size_t{7}}) {
    Sink sink;
    Echo first;
    Echo second;
    emulators::UsbipServer server({.transfers_max = 16}, sink);
    server.add(first, "first");
    server.add(second, "second");
    server.connected(kStart, 1);
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      server.receive(kStart, 1, bytes.subspan(at, std::min(piece, bytes.size() - at)));
    }
    require(server.open_transfers(1) <= 16 && server.open_transfers(2) <= 16);
    server.disconnected(kStart, 1);
    require(server.open_transfers(1) == 0 && !server.imported(1) && !server.imported(2));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  check_decoders(bytes);
  check_server(bytes);
  return 0;
}
