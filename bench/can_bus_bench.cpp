#include "bench/can_bus_bench.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "emulators/can/can_bus.h"
#include "hil/executive/cpu_time.h"
#include "protocols/can/bits.h"
#include "sim/random.h"

namespace rigwire::bench {
namespace {

using protocols::can::Frame;

constexpr std::uint32_t kBitRate_bps = 1'000'000;
constexpr std::int64_t kBit_ns = 1'000'000'000 / kBitRate_bps;
constexpr std::size_t kNodes = 10;
constexpr std::size_t kVariants = 1024;
constexpr std::size_t kWaiting = 4;  ///< Frames of each node.

std::vector<Frame> different_frames() {
  sim::RandomStream random(1, "can_bus_bench");
  std::vector<Frame> frames(kVariants);
  for (Frame& frame : frames) {
    frame.extended = true;
    frame.id = static_cast<std::uint32_t>(random.bits() & 0x1FFF'FFFFU);
    frame.length = static_cast<std::uint8_t>(random.bits() % 9);
    for (std::uint8_t& byte : frame.data) {
      byte = static_cast<std::uint8_t>(random.bits());
    }
  }
  return frames;
}

/// A node that always has frames waiting: one more for each that leaves.
class Sender final : public emulators::FrameOutput {
 public:
  Sender(const std::vector<Frame>& frames, std::size_t first) : frames_(frames), next_(first) {}
  void start(emulators::FrameOutput& node) {
    node_ = &node;
    for (std::size_t i = 0; i < kWaiting; ++i) {
      offer(kStart);
    }
  }
  void send(SimTime due, const Frame& /*frame*/) override {
    last_ = due;
    offer(due);
  }
  [[nodiscard]] SimTime last() const { return last_; }

 private:
  void offer(SimTime due) { node_->send(due, frames_[next_++ % kVariants]); }

  const std::vector<Frame>& frames_;
  std::size_t next_;
  emulators::FrameOutput* node_ = nullptr;
  SimTime last_ = kStart;
};

/// Checks due times between a node and its sender by counting bits.
class Checker final : public emulators::FrameOutput {
 public:
  explicit Checker(std::uint64_t& bits, double& worst_ns, Sender& sender)
      : bits_(bits), worst_ns_(worst_ns), sender_(sender) {}
  void send(SimTime due, const Frame& frame) override {
    bits_ += protocols::can::exact_bits(frame);
    const auto end_ns =
        static_cast<std::int64_t>(bits_ - protocols::can::kInterframeBits) * kBit_ns;
    const auto error_ns = static_cast<double>(due.time_since_epoch().count() - end_ns);
    worst_ns_ = std::max(worst_ns_, std::abs(error_ns));
    sender_.send(due, frame);
  }

 private:
  std::uint64_t& bits_;
  double& worst_ns_;
  Sender& sender_;
};

/// A bus with all its senders.
class FullBus {
 public:
  FullBus(const std::vector<Frame>& frames, bool check) : bus_({kBitRate_bps, 2 * kWaiting}) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      senders_.push_back(std::make_unique<Sender>(frames, i * kVariants / kNodes));
      checkers_.push_back(std::make_unique<Checker>(bits_, worst_ns_, *senders_.back()));
      emulators::FrameOutput& exit =
          check ? static_cast<emulators::FrameOutput&>(*checkers_.back()) : *senders_.back();
      senders_.back()->start(bus_.add_node(exit));
    }
  }
  void run(std::uint64_t frames) {
    for (const std::uint64_t end = bus_.frames() + frames; bus_.frames() < end;) {
      bus_.advance(bus_.next_event());
    }
  }
  [[nodiscard]] double worst_ns() const { return worst_ns_; }
  [[nodiscard]] SimTime last() const {
    SimTime latest = kStart;
    for (const auto& sender : senders_) {
      latest = std::max(latest, sender->last());
    }
    return latest;
  }

 private:
  emulators::CanBusModel bus_;
  std::vector<std::unique_ptr<Sender>> senders_;
  std::vector<std::unique_ptr<Checker>> checkers_;
  std::uint64_t bits_ = 0;
  double worst_ns_ = 0.0;
};

double failed_attempt_ns(const std::vector<Frame>& frames, std::uint64_t attempts) {
  emulators::CanBusModel bus({kBitRate_bps, 2 * kWaiting});
  bus.set_client(kStart, {.present = false});
  Sender sender(frames, 0);
  sender.start(bus.add_node(sender));
  const double begin_s = hil::thread_cpu_seconds();
  while (bus.error_frames() < attempts) {
    bus.advance(bus.next_event());
  }
  return 1e9 * (hil::thread_cpu_seconds() - begin_s) / static_cast<double>(attempts);
}

}  // namespace

CanBusCost measure_can_bus(std::uint64_t frames) {
  const std::vector<Frame> variants = different_frames();
  CanBusCost cost;
  cost.frames = frames;
  FullBus timed(variants, false);
  const double begin_s = hil::thread_cpu_seconds();
  timed.run(frames);
  const double spent_s = hil::thread_cpu_seconds() - begin_s;
  cost.frame_ns = 1e9 * spent_s / static_cast<double>(frames);
  cost.wire_frames_per_s = static_cast<double>(frames) / to_seconds(timed.last());
  cost.core_share = cost.frame_ns * 1e-9 * cost.wire_frames_per_s;
  cost.failed_attempt_ns = failed_attempt_ns(variants, std::max<std::uint64_t>(frames / 10, 1));
  FullBus checked(variants, true);
  checked.run(frames);
  cost.worst_arrival_error_ns = checked.worst_ns();
  return cost;
}

}  // namespace rigwire::bench
