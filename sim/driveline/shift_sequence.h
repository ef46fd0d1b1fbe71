// An automated gear change: torque down, out of gear, engine to the next gear's speed, in, torque
// up.
#pragma once

#include "sim/driveline/parameters.h"

namespace rigwire::sim {

struct GearSelection {
  int gear = 0;  ///< 0 neutral, reverse negative.
  bool crawler_group = false;

  friend bool operator==(const GearSelection&, const GearSelection&) = default;
};

/// Knows times only; whether the target may go in is asked for at each step.
class ShiftSequence {
 public:
  explicit ShiftSequence(const GearboxParameters& parameters);

  void request(const GearSelection& target) { target_ = target; }
  /// `permitted`: the target may be engaged at the present speed. A target that is not permitted
  /// leaves the old gear in; if it stops being permitted on the way, the box stays in neutral until
  /// it is.
  void advance(double h, bool permitted);

  [[nodiscard]] const GearSelection& engaged() const { return engaged_; }
  [[nodiscard]] const GearSelection& target() const { return target_; }
  /// 0 .. 1 of clutch capacity and engine torque.
  [[nodiscard]] double torque_share() const { return share_; }
  [[nodiscard]] bool shifting() const { return phase_ != Phase::steady; }
  /// Out of gear on the way to another: the engine is to turn at its speed.
  [[nodiscard]] bool synchronising() const { return phase_ == Phase::synchronising; }

 private:
  enum class Phase { steady, down, synchronising, up };

  GearboxParameters parameters_;
  GearSelection engaged_;
  GearSelection target_;
  Phase phase_ = Phase::steady;
  double share_ = 0.0;
  double waited_s_ = 0.0;
};

}  // namespace rigwire::sim
