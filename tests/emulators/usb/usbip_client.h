// The client's side of USB/IP in memory, for tests of the server and of devices behind it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "emulators/usb/usbip_server.h"

namespace rigwire::emulators {

/// Keeps what the server sent, by connection.
class RecordedStreams final : public StreamOutput {
 public:
  void send(ConnectionId connection, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    EXPECT_FALSE(closed[connection]) << "bytes after a close";
    auto& stream = streams[connection];
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  void close(ConnectionId connection, SimTime /*due*/) override { closed[connection] = true; }

  std::map<ConnectionId, std::vector<std::uint8_t>> streams;
  std::map<ConnectionId, bool> closed;
};

class UsbipClient {
 public:
  UsbipClient(UsbipServer& server, RecordedStreams& streams, ConnectionId id)
      : server_(server), streams_(streams), id_(id) {
    server_.connected(now, id_);
  }

  void send(std::span<const std::uint8_t> bytes) { server_.receive(now, id_, bytes); }
  void disconnect() { server_.disconnected(now, id_); }
  [[nodiscard]] bool closed() const { return streams_.closed[id_]; }

  std::vector<protocols::usbip::ListedDevice> list() {
    send(protocols::usbip::encode_request(protocols::usbip::DeviceListRequest{}));
    return take(protocols::usbip::decode_device_list(stream()));
  }
  protocols::usbip::ImportReply import(std::string_view bus_id) {
    protocols::usbip::ImportRequest request;
    std::ranges::copy(bus_id, request.bus_id.begin());
    send(protocols::usbip::encode_request(request));
    auto reply = take(protocols::usbip::decode_import_reply(stream()));
    device = (reply.device.bus << 16U) | reply.device.device;
    return reply;
  }

  /// Asks for a transfer; gives its number. `endpoint` with the direction in bit 7.
  std::uint32_t submit(std::uint8_t endpoint, std::uint32_t length,
                       const std::vector<std::uint8_t>& data = {},
                       const protocols::usb::Setup& setup = {}) {
    protocols::usbip::Submit submit;
    submit.number = ++number;
    submit.device = device;
    submit.endpoint = endpoint & 0x0FU;
    submit.to_host = (endpoint & 0x80U) != 0;
    submit.length = length;
    submit.flags = flags;
    submit.packets = packets;
    submit.setup = protocols::usb::encode_setup(setup);
    auto bytes = protocols::usbip::encode(submit);
    std::vector<std::uint8_t> message(bytes.begin(), bytes.end());
    message.insert(message.end(), data.begin(), data.end());
    if (packets != protocols::usbip::kNoPackets) {
      message.resize(bytes.size() + submit.tail_size());
    }
    send(message);
    return number;
  }
  std::uint32_t control(const protocols::usb::Setup& setup,
                        const std::vector<std::uint8_t>& data = {}) {
    return submit(setup.to_host() ? 0x80 : 0x00, setup.length, data, setup);
  }
  std::uint32_t unlink(std::uint32_t transfer) {
    send(protocols::usbip::encode(protocols::usbip::Unlink{++number, device, transfer}));
    return number;
  }

  struct Answer {
    bool unlink = false;
    std::uint32_t number = 0;
    std::int32_t status = 0;
    std::uint32_t actual_length = 0;
    std::vector<std::uint8_t> data;
  };
  /// The next answer; nothing when there is none. `to_host` says whether data follow.
  std::optional<Answer> answer(bool to_host = true) {
    if (stream().empty()) {
      return std::nullopt;
    }
    const auto decoded = take(protocols::usbip::decode_from_device(stream()));
    if (const auto* unlinked = std::get_if<protocols::usbip::UnlinkReply>(&decoded)) {
      return Answer{true, unlinked->number, unlinked->status, 0, {}};
    }
    const auto& reply = std::get<protocols::usbip::SubmitReply>(decoded);
    Answer answer{false, reply.number, reply.status, reply.actual_length, {}};
    if (to_host) {
      auto& rest = stream();
      const auto end = rest.begin() + static_cast<std::ptrdiff_t>(reply.actual_length);
      answer.data.assign(rest.begin(), end);
      rest.erase(rest.begin(), end);
    }
    return answer;
  }

  SimTime now = kStart;
  std::uint32_t device = 0;
  std::uint32_t number = 100;
  std::uint32_t flags = 0;
  std::uint32_t packets = 0;

 private:
  std::vector<std::uint8_t>& stream() { return streams_.streams[id_]; }
  template <class T>
  T take(const protocols::Decoded<T>& decoded) {
    EXPECT_TRUE(decoded.ok());
    T value = decoded.value();
    stream().erase(stream().begin(),
                   stream().begin() + static_cast<std::ptrdiff_t>(decoded.consumed()));
    return value;
  }

  UsbipServer& server_;
  RecordedStreams& streams_;
  ConnectionId id_;
};

}  // namespace rigwire::emulators
