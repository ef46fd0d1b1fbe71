// Every structure and frame that decodes writes back to the bytes that it was read from (reserved
// ones aside); every bit rate is one that the clock can make. The adapter takes any sequence of
// requests, frames, reads, cancellations and news from the bus, ends each transfer at most once,
// and never hands over more than was asked for.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <span>

#include "emulators/usb/gs_usb.h"
#include "protocols/gs_usb/host_frame.h"
#include "protocols/gs_usb/requests.h"

namespace gs_usb = rigwire::protocols::gs_usb;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

template <class Structure>
static void round_trip(std::span<const std::uint8_t> bytes) {
  const auto structure = gs_usb::decode<Structure>(bytes);
  require(structure.ok() == (bytes.size() >= gs_usb::kBytes<Structure>));
  if (structure.ok()) {
    const auto again = gs_usb::encode(*structure);
    require(std::ranges::equal(again, bytes.first(structure.consumed())));
  }
}

static void frame_round_trip(std::span<const std::uint8_t> bytes, bool stamped) {
  const auto frame = gs_usb::decode_frame(bytes, stamped);
  if (!frame.ok()) {
    return;
  }
  const gs_usb::HostFrameBytes again = gs_usb::encode_frame(*frame);
  require(again.size == frame.consumed());
  for (std::size_t i = 0; i < again.size; ++i) {
    constexpr std::size_t kReserved = 11;
    require(i == kReserved || again.bytes[i] == bytes[i]);
  }
  if (const auto sent = gs_usb::to_can(*frame)) {
    require(sent->length <= 8 && sent->id <= 0x1FFFFFFF);
    require(gs_usb::to_can(gs_usb::from_can(*sent)) == sent);
  }
}

namespace {

using namespace rigwire;

class AnyWire final : public emulators::GsUsbWire {
 public:
  void set_controller(SimTime /*now*/, const emulators::OutsideController& set) override {
    require(!set.present || set.bit_rate_bps > 0);
  }
  void send(SimTime /*now*/, const protocols::can::Frame& frame) override {
    require(frame.length <= 8);
    ++unconfirmed;
  }
  unsigned unconfirmed = 0;
};

class AnyHost final : public emulators::UsbHost {
 public:
  void complete(SimTime /*now*/, emulators::UsbTransfer transfer,
                protocols::usb::Outcome /*outcome*/, std::span<const std::uint8_t> data,
                std::size_t /*taken*/) override {
    require(open.erase(transfer) == 1);
    require(data.size() <= kReadBytes || transfer >= kControl);
  }
  static constexpr std::size_t kReadBytes = 22;
  static constexpr emulators::UsbTransfer kControl = 1U << 30U;
  std::set<emulators::UsbTransfer> open;
};

void drive(std::span<const std::uint8_t> bytes) {
  AnyWire wire;
  AnyHost host;
  emulators::GsUsbAdapter adapter({.memory_frames = 16}, wire);
  adapter.plugged(kStart, host);
  SimTime now = kStart;
  emulators::UsbTransfer transfers = 0;
  // The first byte chooses the flags of the mode that it is in at first.
  const std::uint32_t flags = bytes.empty() ? 0U : bytes[0] & 0x9BU;
  const auto request = [&](std::uint8_t number, std::span<const std::uint8_t> data) {
    host.open.insert(AnyHost::kControl);
    adapter.control(now, AnyHost::kControl,
                    {0x41, number, 0, 0, static_cast<std::uint16_t>(data.size())}, data);
  };
  request(1, gs_usb::encode(gs_usb::BitTiming{6, 7, 2, 1, 12}));
  request(2, gs_usb::encode(gs_usb::Mode{gs_usb::Mode::kStart, flags}));
  bytes = bytes.subspan(std::min<std::size_t>(bytes.size(), 1));
  while (bytes.size() >= 3) {
    const std::uint8_t what = bytes[0];
    const std::uint8_t detail = bytes[1];
    const auto data = bytes.subspan(2, std::min<std::size_t>(bytes.size() - 2, bytes[2] % 48U));
    bytes = bytes.subspan(2 + std::max<std::size_t>(data.size(), 1));
    now += std::chrono::milliseconds{detail % 8};
    ++transfers;
    switch (what % 8U) {
      case 0:
      case 1: {
        const emulators::UsbTransfer number = AnyHost::kControl + transfers;
        host.open.insert(number);
        const std::uint8_t type = what % 8U == 0 ? 0x41 : 0xC1;
        adapter.control(now, number,
                        {type, static_cast<std::uint8_t>(detail % 34U), 0, detail,
                         static_cast<std::uint16_t>(type == 0x41 ? data.size() : 64U)},
                        type == 0x41 ? data : std::span<const std::uint8_t>{});
        break;
      }
      case 2:
        host.open.insert(transfers);
        adapter.read(now, transfers, detail == 0 ? 0x82 : 0x81, AnyHost::kReadBytes);
        break;
      case 3:
        host.open.insert(transfers);
        adapter.write(now, transfers, 0x02, data);
        break;
      case 4:
        if (adapter.cancel(now, detail)) {
          require(host.open.erase(detail) == 1);
        }
        break;
      case 5:
        for (; wire.unconfirmed > 0; --wire.unconfirmed) {
          adapter.confirmed(now, (detail & 1U) != 0);
        }
        break;
      case 6:
        adapter.received(now, {detail, false, false, 0, {}});
        break;
      default: {
        protocols::can::ControllerReport report;
        report.state = static_cast<protocols::can::ErrorState>(detail % 4U);
        report.state_changed = (detail & 4U) != 0;
        report.restarted = (detail & 8U) != 0;
        adapter.reported(now, report);
        break;
      }
    }
    adapter.advance(now);
    require(wire.unconfirmed <= 64);
  }
  adapter.unplugged(now);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  round_trip<gs_usb::HostFormat>(bytes);
  round_trip<gs_usb::BitTiming>(bytes);
  round_trip<gs_usb::Mode>(bytes);
  round_trip<gs_usb::BitTimingLimits>(bytes);
  round_trip<gs_usb::DeviceConfiguration>(bytes);
  round_trip<gs_usb::ControllerState>(bytes);
  frame_round_trip(bytes, false);
  frame_round_trip(bytes, true);
  drive(bytes);
  if (const auto timing = gs_usb::decode<gs_usb::BitTiming>(bytes); timing.ok()) {
    const auto rate = gs_usb::bit_rate_bps(*timing, 48'000'000);
    require(!rate || *rate <= 24'000'000);
  }
  return 0;
}
