// Log lines and events about a host that is too slow: one for each stall, and at most one a second
// of wall time, so that a host that is too slow all the time does not fill the log.
#pragma once

#include <functional>
#include <string>

#include "hil/executive/clock.h"
#include "hil/executive/executive.h"

namespace rigwire::hil {

class OverrunLines {
 public:
  /// Receives the instant of simulated time that a line is about, and the line.
  using Use = std::function<void(SimTime at, const std::string& line)>;
  OverrunLines(OverrunPolicy policy, Use use) : policy_(policy), use_(std::move(use)) {}

  /// Reports the stall, or counts it where a line was written less than a second ago.
  void take(const Overrun& overrun, WallTime now);
  /// Reports what was only counted.
  void flush();

 private:
  OverrunPolicy policy_;
  Use use_;
  WallTime next_{};  ///< From when on a line may be written.
  std::uint64_t counted_ = 0;
  Overrun last_;
  Duration together_{0};
};

}  // namespace rigwire::hil
