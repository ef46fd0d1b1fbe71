// The head's motor: where the mirror or the laser bank points at any instant. Independent of the
// firing clock, as in the real sensors.
//
// The controller acts once in a millisecond, on a grid of its own from the start of the run; until
// it acts again the acceleration is constant, and the azimuth is the exact integral of that motion:
// to 1e-12 rad per second of time. So neither slices nor the instants that are asked for change
// anything. A command counts from the controller's next action on.
//
// Speed follows the command with a time constant, within the motor's torque. It wanders about the
// controller's set point as a first-order Gauss-Markov process, and rises and falls once in a turn
// (ripple), at a phase drawn for the unit. The shaft never turns against the commanded direction,
// whatever wander and ripple. The encoder reads the azimuth with noise of its own; beams follow the
// true azimuth. All three fade below 10 rad/s, so that a stopped rotor is at rest.
//
// Phase lock: the controller's set point differs from the commanded speed by the phase's error over
// phase_time_s, by at most phase_speed_share of it; half a turn is made up in 50 turns' time with
// the default. The set point of the phase restarts at each pulse: with a commanded speed that is
// not a whole number of turns per second the lock does not hold, as with the real sensors (VLP-16
// user's manual 63-9243 Rev. D, section "Phase locking": multiples of 60 rpm). Without wander and
// ripple the phase is reached to 1e-6 rad; with a wander of spread s rad/s and correlation time T
// to s phase_time_s sqrt(T / (T + phase_time_s)), one sigma: 2.6 degrees for 1.5 rpm and 0.5 s.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "fields/constants.h"
#include "fields/rules.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

/// Returns the angle less whole turns, within [0, 2 pi).
[[nodiscard]] inline double within_turn(double angle_rad) {
  const double angle = std::fmod(angle_rad, kTurn);
  return angle < 0.0 ? angle + kTurn : angle;
}

/// Azimuth and rate of the rotor, clockwise.
struct RotorState {
  double azimuth_rad = 0.0;  ///< [0, 2 pi)
  double rate_radps = 0.0;
  double encoder_rad = 0.0;  ///< The azimuth as the encoder reads it, [0, 2 pi).
};

struct RotorParameters {
  bool starts_at_rest = false;        ///< Otherwise it turns as commanded from the start.
  double time_constant_s = 0.1;       ///< Time constant of the speed controller.
  double acceleration_radps2 = 30.0;  ///< Maximum: 600 rpm within about 2 s.
  double wander_radps = 0.0;          ///< Spread of the speed. Real sensors: velodyne_heads.h.
  double wander_correlation_s = 0.5;
  double ripple_radps = 0.0;        ///< Amplitude of a change of speed once in a turn.
  double encoder_noise_rad = 0.0;   ///< Spread of what the encoder reads, independent per firing.
  double phase_time_s = 0.4;        ///< In which a small error of the phase falls to 1/e.
  double phase_speed_share = 0.01;  ///< Maximum change of speed for the phase.
};
void visit(fields::Visitor& v, RotorParameters& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const RotorParameters& parameters);

class Rotor {
 public:
  /// At azimuth 0 at the start of the run, or where the phase lock wants it if it turns already and
  /// is locked. What is random depends on (seed, name) only. Validates.
  explicit Rotor(const LidarCommand& command, const RotorParameters& parameters = {},
                 std::uint64_t seed = 0, std::string_view name = {});

  /// Applies from `time` on; `time` must not decrease from call to call. Throws
  /// std::invalid_argument when the rate is not finite or beyond 500 rad/s, or the lock's azimuth
  /// is not finite.
  void command(SimTime time, const LidarCommand& command);

  /// Instants asked for must not decrease from call to call.
  [[nodiscard]] RotorState at(SimTime time);

 private:
  /// The rotor at an action of the controller.
  struct Action {
    SimTime start{};
    double azimuth_rad = 0.0;  ///< [0, 2 pi)
    double rate_radps = 0.0;
  };
  void act();
  [[nodiscard]] double wanted_rate() const;
  [[nodiscard]] double wanted_phase(SimTime time) const;
  [[nodiscard]] double shaft_rate(double azimuth_rad) const;

  RotorParameters parameters_;
  LidarCommand command_;
  std::uint64_t wander_key_ = 0;
  std::uint64_t encoder_key_ = 0;
  double ripple_phase_rad_ = 0.0;  ///< Azimuth at which the rotor is fastest.
  std::uint64_t draws_ = 0;
  double wander_radps_ = 0.0;
  double steered_radps_ = 0.0;        ///< Speed without the wander.
  Action stretch_;                    ///< Last action of the controller.
  Action next_;                       ///< Its next action.
  double acceleration_radps2_ = 0.0;  ///< Acceleration in between.
};

}  // namespace rigwire::sim
