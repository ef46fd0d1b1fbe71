// What an inertial unit does to its samples before it sends them: low-pass filters and the tilt
// filter.
#pragma once

#include <array>

namespace rigwire::emulators {

using Triad = std::array<double, 3>;

/// Second-order Butterworth low-pass over three components, at a fixed sample rate (bilinear
/// transform, cut-off pre-warped: exactly -3 dB at the cut-off). Starts in the steady state of its
/// first input, so there is no transient at power-on. Group delay at low frequency: sqrt(2) / (2 pi
/// cut-off), 9 ms at 25 Hz.
class LowPass {
 public:
  /// A cut-off of 0 passes the input through. Precondition: 0 <= cut_off_hz < sample_rate_hz / 2.
  LowPass(double cut_off_hz, double sample_rate_hz);

  [[nodiscard]] Triad filter(const Triad& input);

 private:
  struct State {
    double first = 0.0;
    double second = 0.0;
  };
  bool pass_through_;
  bool settled_ = false;
  double b0_ = 1.0;
  double a1_ = 0.0;
  double a2_ = 0.0;
  std::array<State, 3> state_{};
};

/// Pitch and roll from rates and specific force, without any truth: the direction of "up" is
/// carried along by the rates and pulled towards the measured specific force (Mahony, Hamel and
/// Pflimlin, IEEE TAC 53(5), 2008, explicit complementary filter with bias estimate, on the gravity
/// direction alone).
///
/// The pull fades to zero when the magnitude of the specific force is 5 % off gravity, so that
/// digging does not tilt the machine; it is ten times stronger for the first second. Then the error
/// of a tilt at rest decays with kTimeConstant_s, and a constant rate bias b leaves b *
/// kTimeConstant_s until the bias estimate has taken it over (about 8 time constants). Steady
/// horizontal acceleration below the fade is read as tilt, as in every such device.
class TiltFilter {
 public:
  static constexpr double kTimeConstant_s = 3.0;
  static constexpr double kInitialisation_s = 1.0;

  /// One step of `period_s`. Aerospace axes (x forward, y right, z down); at rest and level the
  /// specific force is (0, 0, -g).
  void step(const Triad& rate_radps, const Triad& specific_force_mps2, double period_s);

  void reset() { *this = TiltFilter(); }
  /// True during the first second.
  [[nodiscard]] bool initialising() const { return age_s_ < kInitialisation_s; }
  /// The direction of "up", a unit vector in aerospace axes.
  [[nodiscard]] const Triad& up() const { return up_; }
  /// Nose up positive, -pi/2 .. pi/2.
  [[nodiscard]] double pitch_rad() const;
  /// Right side down positive, -pi .. pi.
  [[nodiscard]] double roll_rad() const;

 private:
  Triad up_{0.0, 0.0, -1.0};
  Triad bias_radps_{};
  Triad previous_rate_radps_{};
  double age_s_ = 0.0;
  bool started_ = false;
};

}  // namespace rigwire::emulators
