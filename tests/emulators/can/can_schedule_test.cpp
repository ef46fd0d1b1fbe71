// When frames arrive and who gets through: against bit counts summed here, apart from the model.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "can_test_nodes.h"
#include "emulators/can/can_bus.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::exact_bits;
using protocols::can::Frame;
using rigwire::test::FrameRecorder;
using test::conserved;
using test::Counter;
using test::standard;

/// Hands a node one frame more whenever one has left, and checks the instant of each.
class Endless final : public FrameOutput {
 public:
  Endless(std::uint32_t bit_rate_bps, SimTime start) : rate_(bit_rate_bps), start_(start) {}
  void begin(FrameOutput& node) {
    node_ = &node;
    offer(start_);
  }
  void send(SimTime due, const Frame& frame) override {
    // The end of frame is three bits before the next start; nearest nanosecond, halves up.
    bits_ += exact_bits(frame);
    const std::uint64_t ns = ((bits_ - 3) * 1'000'000'000U + rate_ / 2) / rate_;
    worst_ = std::max(worst_, std::chrono::abs(due - start_ - Duration{std::int64_t(ns)}));
    ++frames;
    offer(due);
  }
  [[nodiscard]] Duration worst() const { return worst_; }
  std::uint64_t frames = 0;

 private:
  void offer(SimTime due) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    Frame frame{static_cast<std::uint32_t>(state_ >> 35U), true, false, 8, {}};
    frame.length = static_cast<std::uint8_t>((state_ >> 20U) % 9);
    for (std::size_t i = 0; i < 8; ++i) {
      frame.data[i] = static_cast<std::uint8_t>(state_ >> (3U * i));
    }
    node_->send(due, frame);
  }

  std::uint64_t rate_;
  SimTime start_;
  FrameOutput* node_ = nullptr;
  std::uint64_t bits_ = 0;
  std::uint64_t state_ = 1;
  Duration worst_{0};
};

TEST(CanSchedule, EveryArrivalIsAWholeNumberOfBitsFromTheFirstEdge) {
  for (const std::uint32_t rate :
       {1'000'000U, 800'000U, 500'000U, 250'000U, 125'000U, 95'238U, 83'333U, 33'333U, 10'000U}) {
    const SimTime start = kStart + 10h + 123'456'789ns;
    Endless sender(rate, start);
    CanBusModel bus({rate, 4});
    sender.begin(bus.add_node(sender));
    bus.advance(start + Duration{3'000'000'000'000'000 / rate});  // Three million bits.
    EXPECT_GT(sender.frames, 20'000U);
    EXPECT_EQ(sender.worst(), 0ns) << rate;
  }
}

TEST(CanSchedule, NothingDriftsInAnHourOfARateThatDoesNotDivideASecond) {
  Endless sender(33'333, kStart);
  CanBusModel bus({33'333, 4});
  sender.begin(bus.add_node(sender));
  bus.advance(kStart + 1h);
  EXPECT_GT(sender.frames, 900'000U);
  EXPECT_EQ(sender.worst(), 0ns);
  EXPECT_DOUBLE_EQ(bus.load(kStart + 1h), 1.0);
}

/// Periodic senders that together want 130 % of the bus, for a minute.
TEST(CanSchedule, OnAFullBusTheLeastUrgentStarvesAndNobodyElse) {
  constexpr std::array<Duration, 6> kPeriods{2ms, 2ms, 2ms, 2ms, 2ms, 2ms};
  Counter outside;
  CanBusModel bus({250'000, 8});
  std::vector<FrameOutput*> nodes;
  for (std::size_t i = 0; i < kPeriods.size(); ++i) {
    nodes.push_back(&bus.add_node(outside));
  }
  for (SimTime now = kStart; now < kStart + 60s; now += kPeriods[0]) {
    bus.advance(now);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      nodes[i]->send(now, standard(0x100 + static_cast<std::uint32_t>(i) * 0x100));
    }
  }
  bus.advance(kStart + 60s);
  // A frame has some 125 bits, half a millisecond: there is room for four in each period.
  const unsigned longest = 135;
  for (std::size_t i = 0; i + 2 < nodes.size(); ++i) {
    const CanNodeCounters counters = bus.counters(*nodes[i]);
    EXPECT_EQ(counters.sent + counters.queued, counters.offered) << i;
    EXPECT_LE(counters.longest_wait, (i + 1) * longest * 4us) << i;
  }
  const CanNodeCounters last = bus.counters(*nodes.back());
  EXPECT_EQ(last.sent, 0U);
  EXPECT_EQ(last.overflowed, last.offered - 8);
  EXPECT_GT(bus.load(kStart + 60s), 0.999);
  for (const FrameOutput* node : nodes) {
    EXPECT_TRUE(conserved(bus.counters(*node)));
  }
}

}  // namespace
}  // namespace rigwire::emulators
