#include "sim/roller/vibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

void visit(fields::Visitor& v, VibrationParameters& p) {
  v.number("frequency", p.frequency_hz, in("Hz").between(0.01, 1000),
           "Frequency of the exciter at full speed.");
  v.number("amplitude", p.amplitude_m, in("mm").at_least(0).at_most(10'000),
           "Amplitude of the drum, zero to peak.");
  v.number("ramp", p.ramp_s, in("s").between(0, 1e5),
           "Time from standstill to full speed and back; 0 = at once.");
  v.number("frame_share", p.frame_share, plain().between(0, 1),
           "Share of the drum's motion that the mounts let through.");
  v.number("frame_phase", p.frame_phase_rad, in("deg").between(-360, 360),
           "Phase by which the frame lags the drum.");
}

void validate(const VibrationParameters& p) {
  fields::check(p);
}

void DrumVibration::step(double h) {
  const double target = on_ ? 1.0 : 0.0;
  const double rate = 2.0 * std::numbers::pi * parameters_.frequency_hz;
  if (speed_ == target) {
    speed_rate_per_s_ = 0.0;
    phase_rad_ += rate * speed_ * h;
  } else if (parameters_.ramp_s == 0.0) {
    speed_ = target;
    speed_rate_per_s_ = 0.0;
    phase_rad_ += rate * speed_ * h;
  } else {
    // Speed share ramps linearly; the phase is its exact integral.
    const double slope = (on_ ? 1.0 : -1.0) / parameters_.ramp_s;
    const double ramp_s = std::min(h, (target - speed_) / slope);
    phase_rad_ += rate * (speed_ + 0.5 * slope * ramp_s) * ramp_s;
    speed_ += slope * ramp_s;
    speed_rate_per_s_ = slope;
    if (ramp_s < h || std::abs(speed_ - target) < 1e-12) {
      speed_ = target;
      speed_rate_per_s_ = 0.0;
      phase_rad_ += rate * target * (h - ramp_s);
    }
  }
  if (speed_ == 0.0) {
    phase_rad_ = 0.0;
  } else if (phase_rad_ > 2.0 * std::numbers::pi) {
    phase_rad_ = std::fmod(phase_rad_, 2.0 * std::numbers::pi);
  }
}

Oscillation DrumVibration::at(double lag_rad, double share) const {
  if (speed_ == 0.0) {
    return {};
  }
  const double e = speed_;
  const double e_rate = speed_rate_per_s_;
  const double amplitude = share * parameters_.amplitude_m;
  // z = A s(e) sin(phi), s = e^2 (3 - 2 e), with the product rule's first and second derivative.
  const double a = amplitude * e * e * (3.0 - 2.0 * e);
  const double a_rate = amplitude * 6.0 * e * (1.0 - e) * e_rate;
  const double a_rate2 = amplitude * (6.0 - 12.0 * e) * e_rate * e_rate;
  const double full = 2.0 * std::numbers::pi * parameters_.frequency_hz;
  const double w = full * e;
  const double w_rate = full * e_rate;
  const double sine = std::sin(phase_rad_ - lag_rad);
  const double cosine = std::cos(phase_rad_ - lag_rad);
  return {a * sine, a_rate * sine + a * w * cosine,
          (a_rate2 - a * w * w) * sine + (2.0 * a_rate * w + a * w_rate) * cosine};
}

}  // namespace rigwire::sim
