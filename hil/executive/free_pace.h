// The pace of a free run with viewers: wall time determines when its output is seen, not what is
// computed and sent.
#pragma once

#include "hil/executive/clock.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

class FreePace {
 public:
  /// Limit of the lag that a run makes up; a longer lag, such as a pause, is given up.
  static constexpr Duration kMadeUp = std::chrono::milliseconds{50};

  /// Precondition: factor > 0, simulated seconds per wall second.
  explicit FreePace(double factor) : factor_(factor) {}

  /// Returns whether a run that has come to `now` may proceed. Counts from the last `now` for which
  /// it returned true. Instants and wall times never go back.
  [[nodiscard]] bool lets_go(SimTime now, WallTime wall);
  /// Precondition: factor > 0.
  void set_factor(double factor) { factor_ = factor; }
  /// Runs as fast as possible up to that instant.
  void hasten(SimTime until) { hastens_until_ = until; }

 private:
  double factor_;
  SimTime hastens_until_ = kStart;
  SimTime left_ = kStart;  ///< Instant at which the run last proceeded,
  WallTime due_{};         ///< and when that was due.
};

}  // namespace rigwire::hil
