#include "sim/driveline/shift_sequence.h"

namespace rigwire::sim {
namespace {

/// Time over a whole, so that a step that ends within rounding of it counts as its end.
constexpr double kRounding = 1e-9;

double part(double h, double whole) {
  return whole > h ? h / whole : 1.0;
}

}  // namespace

ShiftSequence::ShiftSequence(const GearboxParameters& parameters) : parameters_(parameters) {}

void ShiftSequence::advance(double h, bool permitted) {
  const bool neutral_wanted = target_.gear == 0;
  if (phase_ == Phase::steady || phase_ == Phase::up) {
    const bool out_of_gear = neutral_wanted && engaged_.gear != 0;
    if (!(engaged_ == target_) && (permitted || out_of_gear)) {
      phase_ = engaged_.gear == 0 ? Phase::synchronising : Phase::down;
      waited_s_ = 0.0;
    }
  } else if (phase_ == Phase::down && engaged_ == target_) {
    phase_ = Phase::up;  // thought better of it
  }

  // Shares ramp linearly in time; the gear changes at zero torque only.
  switch (phase_) {
    case Phase::steady:
      break;
    case Phase::down:
      share_ -= part(h, parameters_.ramp_down_s);
      if (share_ <= kRounding) {
        share_ = 0.0;
        engaged_.gear = 0;
        phase_ = Phase::synchronising;
        waited_s_ = 0.0;
      }
      break;
    case Phase::synchronising:
      share_ = 0.0;
      waited_s_ += h;
      if (neutral_wanted) {
        engaged_.crawler_group = permitted ? target_.crawler_group : engaged_.crawler_group;
        phase_ = Phase::steady;
      } else if (waited_s_ >= parameters_.synchronisation_s - kRounding) {
        if (permitted) {
          engaged_ = target_;
          phase_ = Phase::up;
        } else {
          phase_ = Phase::steady;
        }
      }
      break;
    case Phase::up:
      share_ += part(h, parameters_.ramp_up_s);
      if (share_ >= 1.0 - kRounding) {
        share_ = 1.0;
        phase_ = Phase::steady;
      }
      break;
  }
}

}  // namespace rigwire::sim
