// A host and a bus for the adapter under test: both only keep what they are told.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "emulators/usb/gs_usb.h"
#include "protocols/gs_usb/requests.h"

namespace rigwire::emulators {

using protocols::can::Frame;
using protocols::gs_usb::BitTiming;
using protocols::gs_usb::Feature;
using protocols::gs_usb::HostFrame;
using protocols::gs_usb::Mode;
using protocols::gs_usb::Request;
using protocols::usb::Outcome;
using protocols::usb::Setup;
using Bytes = std::vector<std::uint8_t>;

constexpr BitTiming k250kbps{6, 7, 2, 1, 12};
constexpr Frame kFrame{0x0CF02980, true, false, 8, {0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0}};

/// The adapter restarts its controller by itself.
constexpr OutsideController kClosed{.present = false, .restart_after = std::nullopt};
constexpr OutsideController opened(std::uint32_t bit_rate_bps, bool listen_only = false,
                                   bool one_shot = false) {
  return {true, bit_rate_bps, listen_only, one_shot, std::nullopt};
}

inline SimTime at_us(std::int64_t microseconds) {
  return kStart + std::chrono::microseconds{microseconds};
}

struct RecordingWire final : GsUsbWire {
  void set_controller(SimTime /*now*/, const OutsideController& controller) override {
    controllers.push_back(controller);
  }
  void send(SimTime /*now*/, const Frame& frame) override { sent.push_back(frame); }

  std::vector<OutsideController> controllers;
  std::vector<Frame> sent;
};

struct RecordingHost final : UsbHost {
  struct Completion {
    UsbTransfer transfer = 0;
    Outcome outcome = Outcome::done;
    Bytes data;
    std::size_t taken = 0;
    SimTime at = kStart;
  };
  void complete(SimTime now, UsbTransfer transfer, Outcome outcome,
                std::span<const std::uint8_t> data, std::size_t taken) override {
    completions.push_back({transfer, outcome, {data.begin(), data.end()}, taken, now});
  }
  [[nodiscard]] const Completion* find(UsbTransfer transfer) const {
    const auto found = std::ranges::find(completions, transfer, &Completion::transfer);
    return found == completions.end() ? nullptr : &*found;
  }

  std::vector<Completion> completions;
};

/// Adapter, host and bus, and what a driver does with them.
class GsUsbWorkbench {
 public:
  GsUsbWorkbench() { adapter.plugged(kStart, host); }

  /// The completion of a request that is answered at once.
  RecordingHost::Completion request(Setup setup, const Bytes& data = {}) {
    const UsbTransfer transfer = ++transfers_;
    adapter.control(now, transfer, setup, data);
    const auto* completion = host.find(transfer);
    return completion == nullptr ? RecordingHost::Completion{} : *completion;
  }
  RecordingHost::Completion ask(Request number, std::uint16_t length, std::uint16_t value = 0) {
    return request({0xC1, static_cast<std::uint8_t>(number), value, 0, length});
  }
  template <class Structure>
  RecordingHost::Completion tell(Request number, const Structure& structure,
                                 std::uint16_t value = 0) {
    const auto bytes = protocols::gs_usb::encode(structure);
    return request({0x41, static_cast<std::uint8_t>(number), value, 0,
                    static_cast<std::uint16_t>(bytes.size())},
                   {bytes.begin(), bytes.end()});
  }
  void start(std::uint32_t flags = 0, const BitTiming& timing = k250kbps) {
    tell(Request::bit_timing, timing);
    tell(Request::mode, Mode{Mode::kStart, flags});
  }
  void stop() { tell(Request::mode, Mode{Mode::kReset, 0}); }

  UsbTransfer read(std::size_t length = 24) {
    const UsbTransfer transfer = ++transfers_;
    adapter.read(now, transfer, 0x81, length);
    return transfer;
  }
  UsbTransfer write(const Bytes& bytes) {
    const UsbTransfer transfer = ++transfers_;
    adapter.write(now, transfer, 0x02, bytes);
    return transfer;
  }
  UsbTransfer transmit(std::uint32_t echo, const Frame& frame = kFrame) {
    HostFrame host_frame = protocols::gs_usb::from_can(frame);
    host_frame.echo = echo;
    const auto bytes = protocols::gs_usb::encode_frame(host_frame);
    return write({bytes.span().begin(), bytes.span().end()});
  }
  /// The frame that a read ended with; nothing while it is open.
  [[nodiscard]] std::optional<HostFrame> frame_of(UsbTransfer transfer,
                                                  bool stamped = false) const {
    const auto* completion = host.find(transfer);
    if (completion == nullptr || completion->outcome != Outcome::done) {
      return std::nullopt;
    }
    const auto frame = protocols::gs_usb::decode_frame(completion->data, stamped);
    return frame.ok() ? std::optional(*frame) : std::nullopt;
  }

  RecordingWire wire;
  RecordingHost host;
  GsUsbAdapter adapter{GsUsbSettings{}, wire};
  SimTime now = kStart;

 private:
  UsbTransfer transfers_ = 0;
};

}  // namespace rigwire::emulators
