#include "emulators/can/can_transmit_queue.h"

#include <algorithm>
#include <cassert>

#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

/// Whether `a` is sent after `b`.
bool less_urgent(const CanWaitingFrame& a, const CanWaitingFrame& b) {
  return a.arbitration_field != b.arbitration_field ? a.arbitration_field > b.arbitration_field
                                                    : a.order > b.order;
}

}  // namespace

CanTransmitQueue::CanTransmitQueue(std::size_t capacity, CanQueueOrder order)
    : capacity_(capacity), policy_(order), ring_(capacity + 1) {
  if (policy_ == CanQueueOrder::priority) {
    urgent_.reserve(capacity + 1);
  }
}

bool CanTransmitQueue::push(SimTime due, const protocols::can::Frame& frame) {
  if (size() >= capacity_) {
    return false;
  }
  CanWaitingFrame& place = ring_[(first_ + waiting_) % ring_.size()];
  place.frame = frame;
  place.due = due;
  place.arbitration_field = protocols::can::arbitration_field(frame);
  place.bits = static_cast<std::uint16_t>(protocols::can::exact_bits(frame));
  place.failed_before = false;
  place.order = pushed_++;
  place.refused_behind = 0;
  ++waiting_;
  return true;
}

void CanTransmitQueue::sort_in(SimTime now) {
  while (waiting_ > 0 && ring_[first_].due <= now) {
    push_urgent(ring_[first_]);
    first_ = (first_ + 1) % ring_.size();
    --waiting_;
  }
}

const CanWaitingFrame& CanTransmitQueue::front(SimTime now) {
  assert(ready() <= now);
  if (policy_ == CanQueueOrder::fifo) {
    return ring_[first_];
  }
  sort_in(now);
  return urgent_.front();
}

CanWaitingFrame CanTransmitQueue::take(SimTime now) {
  if (policy_ == CanQueueOrder::fifo) {
    return drop();
  }
  sort_in(now);
  return pop_urgent();
}

void CanTransmitQueue::put_back(const CanWaitingFrame& frame) {
  if (policy_ == CanQueueOrder::priority) {
    push_urgent(frame);
    return;
  }
  first_ = (first_ + ring_.size() - 1) % ring_.size();
  ring_[first_] = frame;
  ++waiting_;
}

CanWaitingFrame CanTransmitQueue::drop() {
  if (!urgent_.empty()) {
    return pop_urgent();
  }
  const CanWaitingFrame frame = ring_[first_];
  first_ = (first_ + 1) % ring_.size();
  --waiting_;
  return frame;
}

CanWaitingFrame* CanTransmitQueue::newest() {
  return waiting_ == 0 ? nullptr : &ring_[(first_ + waiting_ - 1) % ring_.size()];
}

void CanTransmitQueue::push_urgent(const CanWaitingFrame& frame) {
  urgent_.push_back(frame);
  std::push_heap(urgent_.begin(), urgent_.end(), less_urgent);
}

CanWaitingFrame CanTransmitQueue::pop_urgent() {
  std::pop_heap(urgent_.begin(), urgent_.end(), less_urgent);
  const CanWaitingFrame frame = urgent_.back();
  urgent_.pop_back();
  return frame;
}

}  // namespace rigwire::emulators
