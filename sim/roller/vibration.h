// Vibration of one drum as an analytic motion: amplitude and phase are functions of time that are
// advanced exactly, so that the step changes neither.
//
// The exciter's speed runs up and down linearly, e = 0 .. 1 of the frequency f; the drum's
// displacement, upward positive in the frame, is
//
//     z = A s(e) sin(phi),   phi' = 2 pi f e,   s(e) = e^2 (3 - 2 e)
//
// with the exact first and second derivatives. At full speed the acceleration's amplitude is
// A (2 pi f)^2. The contact does not see this motion: the load on the strips stays the mean one.
#pragma once

#include <numbers>

#include "fields/rules.h"

namespace rigwire::sim {

/// Estimates in the class of the maker's figures (40 .. 55 Hz, 0.2 .. 0.65 mm).
struct VibrationParameters {
  double frequency_hz = 50.0;
  double amplitude_m = 0.5e-3;
  double ramp_s = 1.0;        ///< From standstill to full speed and back; 0 = at once.
  double frame_share = 0.05;  ///< Share of the drum's motion that the rubber mounts transmit.
  double frame_phase_rad = std::numbers::pi;  ///< Phase lag of the frame: above resonance.

  friend bool operator==(const VibrationParameters&, const VibrationParameters&) = default;
};

void visit(fields::Visitor& v, VibrationParameters& p);

/// Throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const VibrationParameters& parameters);

/// One displacement with its derivatives.
struct Oscillation {
  double position_m = 0.0;
  double velocity_mps = 0.0;
  double acceleration_mps2 = 0.0;
};

class DrumVibration {
 public:
  explicit DrumVibration(const VibrationParameters& parameters) : parameters_(parameters) {}

  void command(bool on) { on_ = on; }
  /// Precondition: h > 0.
  void step(double h);

  /// Exciter turning, as commanded.
  [[nodiscard]] bool on() const { return on_; }
  /// Share of the exciter's speed, 0 .. 1.
  [[nodiscard]] double speed_share() const { return speed_; }
  [[nodiscard]] Oscillation drum() const { return at(0.0, 1.0); }
  /// Oscillation of the frame above this drum.
  [[nodiscard]] Oscillation frame() const {
    return at(parameters_.frame_phase_rad, parameters_.frame_share);
  }

 private:
  [[nodiscard]] Oscillation at(double lag_rad, double share) const;

  VibrationParameters parameters_;
  bool on_ = false;
  double speed_ = 0.0;
  double speed_rate_per_s_ = 0.0;
  double phase_rad_ = 0.0;
};

}  // namespace rigwire::sim
