// The pace of a free run that somebody looks at: what is computed and sent hangs on no wall time,
// how soon it is seen does.
#pragma once

#include "hil/executive/clock.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

class FreePace {
 public:
  /// What a run is late by is made up as long as it is no more than this; so is no time that stood.
  static constexpr Duration kMadeUp = std::chrono::milliseconds{50};

  /// Precondition: factor > 0, simulated seconds per wall second.
  explicit FreePace(double factor) : factor_(factor) {}

  /// Whether a run that has come to `now` may go on; true once for each `now` is what it counts
  /// from then. Instants and wall times never go back.
  [[nodiscard]] bool lets_go(SimTime now, WallTime wall);
  /// Precondition: factor > 0.
  void set_factor(double factor) { factor_ = factor; }
  /// Up to that instant as fast as it goes.
  void hasten(SimTime until) { hastens_until_ = until; }

 private:
  double factor_;
  SimTime hastens_until_ = kStart;
  SimTime left_ = kStart;  ///< Where it was let go last,
  WallTime due_{};         ///< and when that was due.
};

}  // namespace rigwire::hil
