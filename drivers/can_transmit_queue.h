// What to do with a frame that a CAN socket does not take.
//
// - ENOBUFS (the interface's own queue, often of ten frames, is full): the frame and those after it
//   wait here, and the owner retries by a timer. A writable socket means nothing: its buffer is far
//   larger than the interface's queue.
// - ENETDOWN, ENETUNREACH (interface down, or its bus off): this frame and all that wait are lost;
//   after an interruption they would be stale.
// - ENXIO, ENODEV (interface removed): all these frames are lost, and the interface is gone.
// - EPERM (listen-only interface) and everything else: the frame is lost.
//
// Every loss is counted by its reason. Source: Linux 6.1, net/can/af_can.c, can_send;
// net/can/raw.c, raw_sendmsg; net/core/dev.c, dev_queue_xmit.
#pragma once

#include <linux/can.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace rigwire::drivers {

struct CanTransmitCounters {
  std::uint64_t sent = 0;       ///< Frames taken by the interface.
  std::uint64_t waited = 0;     ///< Frames among `sent` that were not taken at the first attempt.
  std::uint64_t overflown = 0;  ///< Lost: this queue was full too.
  std::uint64_t down = 0;       ///< Lost: the interface was down, its bus off, or it was removed.
  std::uint64_t forbidden = 0;  ///< Lost: listen-only interface.
  std::uint64_t failed = 0;     ///< Lost: anything else.

  [[nodiscard]] std::uint64_t lost() const { return overflown + down + forbidden + failed; }
};

/// State of an interface, as sending and receiving find it.
enum class CanLink : std::uint8_t { up, down, gone };

class CanTransmitQueue {
 public:
  /// Hands one frame to the system: 0, or errno.
  using Writer = std::function<int(const can_frame&)>;

  /// `capacity` frames may wait, at least one.
  CanTransmitQueue(std::size_t capacity, Writer writer);

  /// False when the frame is lost. True: it is sent, or waits.
  bool offer(const can_frame& frame);
  /// Sends what waits, as far as it goes.
  void retry();
  /// retry() is to be called after a while.
  [[nodiscard]] bool waiting() const { return count_ != 0; }

  [[nodiscard]] CanLink link() const { return link_; }
  /// Sets a state that was found in another way. Down and gone: the frames in the queue are lost.
  void set_link(CanLink link);
  [[nodiscard]] const CanTransmitCounters& counters() const { return counters_; }

 private:
  /// False when the frame has to wait.
  bool settle(int error);

  Writer writer_;
  std::vector<can_frame> ring_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  CanLink link_ = CanLink::up;
  CanTransmitCounters counters_;
};

}  // namespace rigwire::drivers
