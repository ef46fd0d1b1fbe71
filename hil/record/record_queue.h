// A bounded queue of what is to be recorded, from the threads of the run to the one that writes. A
// full queue blocks a thread only where simulated time may wait.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire::hil {

/// One entry of a recording.
struct RecordEntry {
  std::uint16_t track = 0;  ///< The writer's number of a wire, the truth or the events.
  std::uint8_t flags = 0;   ///< Meaning depends on the track.
  SimTime at{};
  std::span<const std::uint8_t> bytes;
};

/// First in, first out. Any number of threads put, one takes.
class RecordQueue {
 public:
  /// Room for `bytes` bytes, twice; the system allocates them when they are used. put() waits up to
  /// `patience` while the queue is full; zero: never.
  RecordQueue(std::size_t bytes, std::chrono::milliseconds patience);

  /// Returns false, and counts the entry as lost for its track, when there is no room. After one
  /// put() has waited in vain, later ones do not wait until there is room again.
  bool put(const RecordEntry& entry);

  /// Returns what came since the last call, in order; waits at most `until` for something. Entries
  /// are valid until the next call. Empty after close() when nothing is left.
  struct Taken {
    std::vector<RecordEntry> entries;
    std::vector<std::uint64_t> lost;  ///< By track, before the entries.
  };
  [[nodiscard]] const Taken& take(std::chrono::milliseconds until);
  /// Drops all further entries, until open().
  void close();
  /// Starts again, empty. Precondition: no thread is in take().
  void open();
  [[nodiscard]] bool closed() const;

 private:
  const std::size_t room_;
  const std::chrono::milliseconds patience_;

  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::condition_variable taken_;
  std::vector<std::uint8_t> filling_;  ///< Heads and bytes.
  std::vector<std::uint64_t> lost_;
  bool closed_ = false;
  bool out_of_patience_ = false;

  std::vector<std::uint8_t> taking_;  ///< The writer's.
  Taken row_;
};

}  // namespace rigwire::hil
