#include "bench/gs_usb_bench.h"

#include <algorithm>
#include <array>
#include <span>

#include "bench/cost.h"
#include "emulators/usb/gs_usb.h"
#include "emulators/usb/usbip_server.h"
#include "protocols/can/bits.h"
#include "protocols/usb/transfer.h"

namespace rigwire::bench {
namespace {

namespace gs_usb = protocols::gs_usb;
namespace usbip = protocols::usbip;
using protocols::can::Frame;

constexpr double kBitRate_bps = 1e6;

/// A bus that confirms at once.
class Wire final : public emulators::GsUsbWire {
 public:
  void set_controller(SimTime /*now*/, const emulators::OutsideController& /*set*/) override {}
  void send(SimTime /*now*/, const Frame& frame) override {
    sent = frame;
    ++unconfirmed;
  }
  Frame sent;
  unsigned unconfirmed = 0;
};

/// The kernel's side: thirty reads wait, each that ended is asked for again.
class Host final : public emulators::StreamOutput {
 public:
  void send(emulators::ConnectionId /*connection*/, SimTime /*due*/,
            std::span<const std::uint8_t> bytes) override {
    if (bytes.size() == usbip::kCommandHeaderSize + gs_usb::kStampedFrameBytes) {
      const auto frame = gs_usb::decode_frame(bytes.subspan(usbip::kCommandHeaderSize), true);
      if (frame.ok()) {
        latest = *frame;
        ++frames;
      }
    }
  }
  void close(emulators::ConnectionId /*connection*/, SimTime /*due*/) override {}

  gs_usb::HostFrame latest;
  std::uint64_t frames = 0;
};

class Bench {
 public:
  Bench() : adapter_({}, wire_), server_({}, host_) {
    server_.add(adapter_, "bench");
    server_.connected(kStart, kConnection);
    usbip::ImportRequest import;
    import.bus_id = {'1', '-', '1'};
    server_.receive(kStart, kConnection, usbip::encode_request(import));
    constexpr protocols::usb::Setup kConfigure{0x00, 9, 1, 0, 0};  // SET_CONFIGURATION 1
    control(kConfigure, {});
    const auto timing = gs_usb::encode(gs_usb::BitTiming{5, 6, 4, 1, 3});  // 1 Mbit/s
    control({0x41, 1, 0, 0, timing.size()}, timing);
    const auto mode =
        gs_usb::encode(gs_usb::Mode{gs_usb::Mode::kStart, gs_usb::Feature::kTimeStamp});
    control({0x41, 2, 0, 0, mode.size()}, mode);
    for (int i = 0; i < 30; ++i) {
      read();
    }
  }

  /// One frame from the bus.
  void receive(const Frame& frame) {
    adapter_.received(kStart, frame);
    read();
    wrong_ += gs_usb::to_can(host_.latest) == frame ? 0U : 1U;
  }
  /// One frame from the host, confirmed, and its echo.
  void transmit(const Frame& frame) {
    gs_usb::HostFrame host_frame = gs_usb::from_can(frame);
    host_frame.echo = echo_ = (echo_ + 1) % 10;
    usbip::Submit submit;
    submit.endpoint = gs_usb::kEndpointToDevice;
    submit.length = gs_usb::kFrameBytes;
    std::array<std::uint8_t, usbip::kCommandHeaderSize + gs_usb::kFrameBytes> message{};
    std::ranges::copy(begin(submit), message.begin());
    std::ranges::copy(gs_usb::encode_frame(host_frame).span(),
                      message.begin() + usbip::kCommandHeaderSize);
    server_.receive(kStart, kConnection, message);
    for (; wire_.unconfirmed > 0; --wire_.unconfirmed) {
      adapter_.confirmed(kStart, true);
    }
    read();
    wrong_ += wire_.sent == frame && host_.latest.echo == echo_ ? 0U : 1U;
  }
  [[nodiscard]] std::uint64_t wrong() const { return wrong_ + adapter_.counters().lost; }

 private:
  static constexpr emulators::ConnectionId kConnection = 1;
  static constexpr std::uint32_t kDevice = (1U << 16U) | 1U;

  [[nodiscard]] usbip::CommandBytes begin(usbip::Submit& submit) {
    submit.number = ++number_;
    submit.device = kDevice;
    return usbip::encode(submit);
  }
  void read() {
    usbip::Submit submit;
    submit.to_host = true;
    submit.endpoint = gs_usb::kEndpointToHost & 0x0FU;
    submit.length = gs_usb::kStampedFrameBytes;
    server_.receive(kStart, kConnection, begin(submit));
  }
  void control(const protocols::usb::Setup& setup, std::span<const std::uint8_t> data) {
    usbip::Submit submit;
    submit.setup = protocols::usb::encode_setup(setup);
    submit.length = static_cast<std::uint32_t>(data.size());
    server_.receive(kStart, kConnection, begin(submit));
    server_.receive(kStart, kConnection, data);
  }

  Wire wire_;
  Host host_;
  emulators::GsUsbAdapter adapter_;
  emulators::UsbipServer server_;
  std::uint32_t number_ = 0;
  std::uint32_t echo_ = 0;
  std::uint64_t wrong_ = 0;
};

/// Different data each time; the shortest frame has none.
std::vector<Frame> variants(bool shortest) {
  std::vector<Frame> frames(kCostVariants);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto number = static_cast<std::uint8_t>(i);
    frames[i] = shortest ? Frame{0x100U + number, false, false, 0, {}}
                         : Frame{0x0CF02980, true, false, 8, {number, 1, 2, 3, 4, 5, 6, number}};
  }
  return frames;
}

double frames_per_second(const std::vector<Frame>& frames) {
  double bits = 0.0;
  for (const Frame& frame : frames) {
    bits += protocols::can::exact_bits(frame);
  }
  return kBitRate_bps * static_cast<double>(frames.size()) / bits;
}

}  // namespace

std::vector<GsUsbCost> measure_gs_usb() {
  std::vector<GsUsbCost> costs;
  for (const bool shortest : {false, true}) {
    const auto frames = variants(shortest);
    for (const bool to_host : {true, false}) {
      Bench bench;
      GsUsbCost cost;
      cost.way = to_host ? "to the host" : "from the host and back as its echo";
      cost.frame = shortest ? "11-bit, empty" : "29-bit, 8 bytes";
      cost.nanoseconds = nanoseconds_of([&](int i) {
        const Frame& frame = frames[static_cast<std::size_t>(i)];
        to_host ? bench.receive(frame) : bench.transmit(frame);
      });
      cost.per_second = 1e9 / cost.nanoseconds;
      cost.wire_limit_per_second = frames_per_second(frames);
      cost.core_share = cost.wire_limit_per_second / cost.per_second;
      cost.wrong = bench.wrong();
      costs.push_back(cost);
    }
  }
  return costs;
}

}  // namespace rigwire::bench
