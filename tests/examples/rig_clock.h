// The clock of a machine on real wires: the wall's, but a busy host costs it time and no accuracy.
// While this process, or the program that works the machine, was held up, the machine stood. So a
// driver that is late by half a second because four compilers run beside it is no worse a driver.
#pragma once

#include <chrono>

#include "sim/samples/time.h"

namespace rigwire::test {

class RigClock {
 public:
  /// For tests of what the machine does when its program says nothing for a while.
  bool waits_for_client = true;

  /// The client has sent something.
  void heard() {
    heard_ = std::chrono::steady_clock::now();
    has_client_ = true;
  }

  [[nodiscard]] SimTime now() {
    const auto present = std::chrono::steady_clock::now();
    if (const auto lag = present - looked_ - kLongestTurn; lag > lag.zero()) {
      stood_ += lag;
    } else if (const auto silent = present - heard_;
               waits_for_client && has_client_ && silent > kLongestTurn && silent < kPatience) {
      stood_ += present - looked_;
    }
    looked_ = present;
    return kStart + std::chrono::duration_cast<Duration>(present - started_ - stood_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  /// Programs send every 50 ms.
  static constexpr std::chrono::milliseconds kLongestTurn{100};
  /// Whoever is silent for longer has ended.
  static constexpr std::chrono::seconds kPatience{2};

  Clock::time_point started_ = Clock::now();
  Clock::time_point looked_ = started_;  ///< When `now` was last asked.
  Clock::time_point heard_ = started_;
  Clock::duration stood_{};
  bool has_client_ = false;
};

}  // namespace rigwire::test
