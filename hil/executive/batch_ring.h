// The hand-over of sample batches from the thread that computes truth to the thread that owns the
// devices: a ring of reused slots, bounded, so that truth never runs further ahead than the ring.
// First in, first out. The ring owns the slots; a pointer to one holds until publish() or
// release().
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <vector>

#include "hil/executive/truth_source.h"

namespace rigwire::hil {

/// One producer thread, one consumer thread.
class BatchRing {
 public:
  explicit BatchRing(std::size_t slots);

  /// Producer: the slot to fill next; waits while all are full. nullptr after close().
  SampleBatch* acquire();
  /// Producer: hands over the acquired slot.
  void publish();

  /// Consumer: the oldest batch, or nullptr.
  const SampleBatch* front();
  /// Consumer: gives the front slot back. Precondition: front() != nullptr.
  void release();

  /// Wakes and ends the producer.
  void close();

 private:
  std::vector<SampleBatch> slots_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  bool closed_ = false;
  std::mutex mutex_;
  std::condition_variable room_;
};

}  // namespace rigwire::hil
