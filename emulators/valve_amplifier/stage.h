// One section's output stage: ramp, gain, dead band jump and polarity between a command and the
// spool set point. Pure arithmetic over time; the valve amplifier owns one per section.
#pragma once

#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Parameters of one section, as fractions.
struct ValveStageParameters {
  double dead_band_positive = 0.0;  ///< 0 .. 0.5 of spool travel.
  double dead_band_negative = 0.0;  ///< 0 .. 0.5 of spool travel.
  Duration ramp_up{0};              ///< Neutral to full command; 0 = at once.
  Duration ramp_down{0};            ///< Full command to neutral; 0 = at once.
  double gain = 1.0;                ///< 0 .. 2.
  double polarity = 1.0;            ///< 1 or -1.

  friend bool operator==(const ValveStageParameters&, const ValveStageParameters&) = default;
};

class ValveStage {
 public:
  /// The command to go to, -1 .. 1, from `now` on. Without a ramp it is reached at once.
  void set_target(SimTime now, double command, const ValveStageParameters& parameters);
  /// Moves along the ramp until `now`. Times must not decrease.
  void advance(SimTime now, const ValveStageParameters& parameters);
  /// To neutral at once, past every ramp.
  void neutral(SimTime now);

  [[nodiscard]] bool ramping() const { return ramped_ != target_; }
  /// Spool set point, -1 .. 1: with c the ramped command times gain, held within -1 .. 1, and b the
  /// dead band of its sign, polarity * sign(c) * (b + (1 - b) |c|); 0 for c = 0.
  [[nodiscard]] double opening(const ValveStageParameters& parameters) const;

 private:
  SimTime moved_until_{};
  double target_ = 0.0;
  double ramped_ = 0.0;
};

}  // namespace rigwire::emulators
