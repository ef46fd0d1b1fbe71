#include "emulators/can/can_bus.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>

#include "protocols/can/bits.h"

namespace rigwire::emulators {

using protocols::can::Frame;

void validate(const CanBusSettings& settings) {
  if (settings.bit_rate_bps < 10'000 || settings.bit_rate_bps > 1'000'000) {
    throw std::invalid_argument("CAN bus: bit_rate_bps is " +
                                std::to_string(settings.bit_rate_bps) +
                                ", allowed is 10000 .. 1000000");
  }
  if (settings.queue_frames < 1 || settings.queue_frames > 65'536) {
    throw std::invalid_argument("CAN bus: queue_frames is " +
                                std::to_string(settings.queue_frames) + ", allowed is 1 .. 65536");
  }
}

/// A node's transmit queue, a ring of fixed size.
class CanBusModel::Node final : public FrameOutput {
 public:
  /// `exit` is nullptr for the outside itself.
  Node(std::size_t capacity, FrameOutput* exit_output) : exit(exit_output), ring_(capacity) {}

  void send(SimTime due, const Frame& frame) override {
    if (count_ == ring_.size()) {
      ++counters.overflowed;
      return;
    }
    ring_[(head_ + count_) % ring_.size()] = {due, frame};
    ++count_;
  }

  [[nodiscard]] SimTime ready() const { return count_ == 0 ? kNever : ring_[head_].due; }
  [[nodiscard]] const Frame& front() const { return ring_[head_].frame; }
  void pop() {
    head_ = (head_ + 1) % ring_.size();
    --count_;
  }

  FrameOutput* const exit;
  CanDevice* device = nullptr;
  CanNodeCounters counters;

 private:
  struct Waiting {
    SimTime due;
    Frame frame;
  };
  std::vector<Waiting> ring_;
  std::size_t head_ = 0;
  std::size_t count_ = 0;
};

CanBusModel::CanBusModel(const CanBusSettings& settings) : settings_(settings) {
  validate(settings);
  nodes_.push_back(std::make_unique<Node>(settings.queue_frames, nullptr));
}

CanBusModel::~CanBusModel() = default;

FrameOutput& CanBusModel::add_node(FrameOutput& exit, const CanNodeSettings& /*node*/) {
  nodes_.push_back(std::make_unique<Node>(settings_.queue_frames, &exit));
  return *nodes_.back();
}

void CanBusModel::attach(FrameOutput& output, CanDevice& device) {
  node_of(output).device = &device;
}

CanBusModel::Node& CanBusModel::node_of(const FrameOutput& output) const {
  const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                  [&output](const auto& node) { return node.get() == &output; });
  if (found == nodes_.end()) {
    throw std::invalid_argument("CAN bus: the output is not one of this bus's nodes");
  }
  return **found;
}

CanNodeCounters CanBusModel::counters(const FrameOutput& output) const {
  return node_of(output).counters;
}

CanNodeCounters CanBusModel::outside_counters() const {
  return nodes_.front()->counters;
}

void CanBusModel::receive(SimTime now, const Frame& frame) {
  nodes_.front()->send(now, frame);
}

Duration CanBusModel::bits(std::uint64_t count) const {
  return Duration{static_cast<std::int64_t>((count * 1'000'000'000U + settings_.bit_rate_bps / 2) /
                                            settings_.bit_rate_bps)};
}

SimTime CanBusModel::start_time() const {
  SimTime earliest = kNever;
  for (const auto& node : nodes_) {
    earliest = std::min(earliest, node->ready());
  }
  return earliest == kNever ? kNever : std::max(earliest, free_at_);
}

SimTime CanBusModel::decision_time() const {
  const SimTime start = start_time();
  return start == kNever ? kNever : start + bits(1);
}

SimTime CanBusModel::next_event() const {
  return sender_ != nullptr ? end_of_frame_ : decision_time();
}

void CanBusModel::advance(SimTime now) {
  while (next_event() <= now) {
    if (sender_ != nullptr) {
      complete();
    } else {
      arbitrate();
    }
  }
}

void CanBusModel::arbitrate() {
  const SimTime start = start_time();
  // Who becomes ready within the first bit sees the start of frame and joins.
  const SimTime last = start + bits(1) - Duration{1};
  bool tie = false;
  std::uint32_t lowest = 0;
  sender_ = nullptr;
  for (const auto& node : nodes_) {
    if (node->ready() > last) {
      continue;
    }
    const std::uint32_t field = protocols::can::arbitration_field(node->front());
    if (sender_ == nullptr || field < lowest) {
      sender_ = node.get();
      lowest = field;
      tie = false;
    } else if (field == lowest) {
      tie = true;
    }
  }
  collisions_ += tie ? 1U : 0U;
  on_wire_ = sender_->front();
  sender_->pop();
  const unsigned length = protocols::can::exact_bits(on_wire_);
  end_of_frame_ = start + bits(length - protocols::can::kInterframeBits);
  free_at_ = start + bits(length);
  occupy(start, free_at_);
}

void CanBusModel::complete() {
  Node* const sender = sender_;
  const SimTime instant = end_of_frame_;
  const Frame frame = on_wire_;
  sender_ = nullptr;
  end_of_frame_ = kNever;
  ++frames_;
  ++sender->counters.sent;
  for (const auto& node : nodes_) {
    if (node.get() != sender && node->device != nullptr) {
      node->device->receive(instant, frame);
    }
  }
  if (sender->exit != nullptr) {
    sender->exit->send(instant, frame);
  }
}

void CanBusModel::occupy(SimTime begin, SimTime end) {
  const auto size = static_cast<std::int64_t>(busy_ns_.size());
  while (begin < end) {
    const std::int64_t bucket = begin.time_since_epoch() / kLoadBucket;
    newest_bucket_ = std::max(newest_bucket_, bucket - size);
    while (newest_bucket_ < bucket) {
      ++newest_bucket_;
      busy_ns_[static_cast<std::size_t>(newest_bucket_ % size)] = 0;
    }
    const SimTime bucket_end{(bucket + 1) * kLoadBucket};
    const SimTime until = std::min(end, bucket_end);
    busy_ns_[static_cast<std::size_t>(bucket % size)] += (until - begin).count();
    begin = until;
  }
}

double CanBusModel::load(SimTime now) const {
  const auto size = static_cast<std::int64_t>(busy_ns_.size());
  const std::int64_t current = now.time_since_epoch() / kLoadBucket;
  std::int64_t busy = 0;
  for (std::int64_t bucket = current - static_cast<std::int64_t>(kLoadBuckets); bucket < current;
       ++bucket) {
    if (bucket >= 0 && bucket <= newest_bucket_ && bucket > newest_bucket_ - size) {
      busy += busy_ns_[static_cast<std::size_t>(bucket % size)];
    }
  }
  return static_cast<double>(busy) * 1e-9;
}

}  // namespace rigwire::emulators
