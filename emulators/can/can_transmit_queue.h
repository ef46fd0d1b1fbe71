// The frames that one node still has to send.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "emulators/can/can_node.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// A frame with what the bus asks of it again and again, computed once.
struct CanWaitingFrame {
  protocols::can::Frame frame;
  SimTime due = kNever;                 ///< From when on the host wants it sent.
  std::uint32_t arbitration_field = 0;  ///< protocols/can/bits.h
  std::uint16_t bits = 0;               ///< exact_bits()
  bool failed_before = false;
  std::uint64_t order = 0;
  std::uint64_t refused_behind = 0;  ///< Frames refused after this one and before the next.
};

/// Allocates at construction only.
class CanTransmitQueue {
 public:
  CanTransmitQueue(std::size_t capacity, CanQueueOrder order);

  /// False when it is full. `due` never decreases from call to call.
  bool push(SimTime due, const protocols::can::Frame& frame);
  [[nodiscard]] std::size_t size() const { return waiting_ + urgent_.size(); }

  /// From when on take() has a frame to give; kStart: it has one already.
  [[nodiscard]] SimTime ready() const {
    return !urgent_.empty() ? kStart : waiting_ == 0 ? kNever : ring_[first_].due;
  }
  /// The one that is to be offered to the bus at `now`. Precondition: ready() <= now. Valid until
  /// the next call.
  [[nodiscard]] const CanWaitingFrame& front(SimTime now);
  /// Takes front(now) out.
  CanWaitingFrame take(SimTime now);
  /// What take() gave and could not be sent. It keeps its place.
  void put_back(const CanWaitingFrame& frame);
  /// The oldest one, due or not. Precondition: not empty.
  CanWaitingFrame drop();
  /// The one that was pushed last, or nullptr. With CanQueueOrder::fifo only.
  [[nodiscard]] CanWaitingFrame* newest();

 private:
  void push_urgent(const CanWaitingFrame& frame);
  CanWaitingFrame pop_urgent();
  void sort_in(SimTime now);

  std::size_t capacity_;
  CanQueueOrder policy_;
  std::vector<CanWaitingFrame> ring_;  ///< In order of arrival; with a place for put_back().
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
  std::vector<CanWaitingFrame> urgent_;  ///< Due ones, a heap; CanQueueOrder::priority only.
  std::uint64_t pushed_ = 0;
};

}  // namespace rigwire::emulators
