// What is to be recorded, from the threads where it happens to the one that writes: bounded, and
// never waited for unless simulated time may wait.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire::hil {

/// One thing of a recording.
struct RecordEntry {
  std::uint16_t track = 0;  ///< A wire, the truth, the events: the writer's number of it.
  std::uint8_t flags = 0;   ///< Meaning is the track's.
  SimTime at{};
  std::span<const std::uint8_t> bytes;
};

/// First in, first out. Any number of threads put, one takes.
class RecordQueue {
 public:
  /// Room for `bytes` bytes, twice; the system gives them when they are used. A full queue is
  /// waited for `patience`; zero: never.
  RecordQueue(std::size_t bytes, std::chrono::milliseconds patience);

  /// False: there was no room, and the entry is counted as lost for its track. The queue stays full
  /// for others that wait, too: who did not get room once does not wait again until there is some.
  bool put(const RecordEntry& entry);

  /// What came since the last call, as one row; waits at most `until` for something. Entries are
  /// valid until the next call. Empty after close() when nothing is left.
  struct Taken {
    std::vector<RecordEntry> entries;
    std::vector<std::uint64_t> lost;  ///< By track, before the entries.
  };
  [[nodiscard]] const Taken& take(std::chrono::milliseconds until);
  /// Nothing more is kept of what is put, until open().
  void close();
  /// Begins anew, empty. Nobody may be taking.
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
