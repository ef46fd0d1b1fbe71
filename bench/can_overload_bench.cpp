#include "bench/can_overload_bench.h"

#include <cstddef>

#include "emulators/can/can_bus.h"
#include "emulators/device.h"
#include "protocols/can/bits.h"

namespace rigwire::bench {
namespace {

using protocols::can::Frame;

constexpr std::uint32_t kCanOverloadBitRate_bps = 250'000;
constexpr std::size_t kCanOverloadNodes = 8;
constexpr std::size_t kQueue = 8;
constexpr double kOfferedLoad = 1.3;
constexpr Duration kStagger = std::chrono::microseconds(137);

Frame frame_of(std::size_t node) {
  Frame frame;
  frame.extended = true;
  frame.id = 0x0CF0'0000U + 0x0001'0000U * static_cast<std::uint32_t>(node);
  frame.length = 8;
  frame.data.fill(0x5A);
  return frame;
}

struct Load {
  Frame frame;
  emulators::FrameOutput* node = nullptr;
  Duration period{};
  SimTime next = kStart;
};

}  // namespace

// All nodes offer the same load, kOfferedLoad together; the node with the earliest next frame
// sends, event by event.
CanOverload measure_can_overload(int seconds) {
  emulators::CanBusModel bus({kCanOverloadBitRate_bps, kQueue});
  emulators::NullFrameOutput nowhere;
  std::vector<Load> loads(kCanOverloadNodes);
  CanOverload result;
  for (std::size_t i = 0; i < kCanOverloadNodes; ++i) {
    Load& load = loads[i];
    load.frame = frame_of(i);
    load.node = &bus.add_node(nowhere);
    const double length_s =
        protocols::can::exact_bits(load.frame) / double{kCanOverloadBitRate_bps};
    load.period =
        Duration{static_cast<std::int64_t>(1e9 * length_s * kCanOverloadNodes / kOfferedLoad)};
    load.next = kStart + static_cast<std::int64_t>(i) * kStagger;
    result.offered_load += length_s / to_seconds(load.period);
  }
  const SimTime end = kStart + std::chrono::seconds(seconds);
  for (;;) {
    Load* first = &loads.front();
    for (Load& load : loads) {
      first = load.next < first->next ? &load : first;
    }
    if (first->next >= end) {
      break;
    }
    bus.advance(first->next);
    first->node->send(first->next, first->frame);
    first->next += first->period;
  }
  bus.advance(end);
  result.bus_load = bus.load(end);
  for (const Load& load : loads) {
    const emulators::CanNodeCounters counters = bus.counters(*load.node);
    result.nodes.push_back(
        {load.frame.id, static_cast<double>(counters.offered) / seconds,
         static_cast<double>(counters.sent) / seconds,
         static_cast<double>(counters.overflowed) / static_cast<double>(counters.offered),
         1e3 * to_seconds(counters.longest_wait)});
  }
  return result;
}

}  // namespace rigwire::bench
