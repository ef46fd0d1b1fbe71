// One valve section: from the commanded opening to the flow that its compensator asks for.
#pragma once

#include "sim/hydraulics/parameters.h"

namespace rigwire::sim {

/// The spool follows its command by x' = (u - x) / time_constant with |x'| limited to the rate.
/// step() is the exact solution, so that dividing a step changes nothing beyond rounding.
class Spool {
 public:
  explicit Spool(const SpoolParameters& parameters);

  /// -1 .. 1 of full travel, clamped. Not-a-number is refused: returns false, keeps the old one.
  bool command(double opening);
  void step(double span_s);

  [[nodiscard]] double position() const { return position_; }

  /// Signed, m3/s: zero inside the dead band, from there proportional up to flow_max at full
  /// travel, back_share of it the other way, whatever the load (pressure compensation).
  [[nodiscard]] double flow_request_m3ps() const;

 private:
  SpoolParameters parameters_;
  double command_ = 0.0;
  double position_ = 0.0;
};

}  // namespace rigwire::sim
