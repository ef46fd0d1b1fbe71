// Every structure and frame that decodes writes back to the bytes that it was read from (reserved
// ones aside); every bit rate is one that the clock can make.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

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
  if (const auto timing = gs_usb::decode<gs_usb::BitTiming>(bytes); timing.ok()) {
    const auto rate = gs_usb::bit_rate_bps(*timing, 48'000'000);
    require(!rate || *rate <= 24'000'000);
  }
  return 0;
}
