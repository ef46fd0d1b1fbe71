#include "sim/lidar/rotor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/visitor.h"
#include "sim/lidar/counter_noise.h"
#include "sim/random.h"

namespace rigwire::sim {

using fields::in;

namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{1};
constexpr double kPeriod_s = to_seconds(kPeriod);
constexpr Duration kPulsePeriod = std::chrono::seconds{1};
constexpr double kGreatestRate_radps = 500.0;
/// Below this speed wander, ripple and the encoder's noise fade with it.
constexpr double kSteadyRate_radps = 10.0;
/// A speed that is as near as this to the wanted one takes it.
constexpr double kSameRate_radps = 0.01;

/// Returns the angle within [0, 2 pi), if it left that by one turn at most.
double back_into_turn(double angle_rad) {
  return angle_rad >= kTurn ? angle_rad - kTurn : angle_rad < 0.0 ? angle_rad + kTurn : angle_rad;
}

/// How much of what makes a rotor uneven acts at that speed, 0 .. 1.
double unsteadiness(double rate_radps) {
  return std::min(1.0, std::abs(rate_radps) / kSteadyRate_radps);
}

double counter_gaussian(std::uint64_t key, std::uint64_t counter) {
  const double p = counter_uniform(key, counter);
  const double q = p - 0.5;
  if (std::abs(q) <= kCentralHalfWidth) {
    return central_normal_quantile<double>(q);
  }
  return std::copysign(outer_normal_quantile<double>(std::sqrt(-std::log(std::min(p, 1.0 - p)))),
                       q);
}

void check(const LidarCommand& command) {
  if (!(std::abs(command.rotor_rate_radps) <= kGreatestRate_radps)) {
    throw std::invalid_argument("lidar rotor: the rate is out of range, found " +
                                std::to_string(command.rotor_rate_radps) +
                                " rad/s, allowed -500 .. 500 rad/s");
  }
  if (command.phase_lock && !std::isfinite(command.phase_lock->azimuth_rad)) {
    throw std::invalid_argument("lidar rotor: the phase lock's azimuth is not a finite number");
  }
}

}  // namespace

void visit(fields::Visitor& v, RotorParameters& p) {
  v.boolean("starts_at_rest", p.starts_at_rest,
            "Whether it is at rest at the start; otherwise it turns as commanded.");
  v.number("time_constant", p.time_constant_s, in("s").between(0.001, 60),
           "Time constant of the speed controller.");
  v.number("acceleration", p.acceleration_radps2, in("rad/s2").between(0.1, 10000),
           "Greatest acceleration, by the motor's torque.");
  v.number("wander", p.wander_radps, in("rpm").between(0, 100),
           "Spread of the speed over minutes.");
  v.number("wander_correlation", p.wander_correlation_s, in("s").between(0.01, 1000),
           "Time in which the wander changes.");
  v.number("ripple", p.ripple_radps, in("rpm").between(0, 100),
           "Change of speed that comes once in a turn, amplitude.");
  v.number("encoder_noise", p.encoder_noise_rad, in("deg").between(0, 1),
           "Noise of the azimuth that the encoder reads, per firing.");
  v.number("phase_time", p.phase_time_s, in("s").between(0.01, 60),
           "Time in which the phase lock's error falls to 1/e.");
  v.number("phase_speed", p.phase_speed_share, in("%").between(0.01, 20),
           "Greatest change of speed for the phase lock.");
}

void validate(const RotorParameters& p) {
  fields::check(p);
}

Rotor::Rotor(const LidarCommand& command, const RotorParameters& parameters, std::uint64_t seed,
             std::string_view name)
    : parameters_(parameters), command_(command) {
  validate(parameters);
  check(command);
  RandomStream unit(seed, std::string(name) + "/rotor");
  wander_key_ = unit.bits();
  encoder_key_ = unit.bits();
  ripple_phase_rad_ = kTurn * unit.uniform();
  wander_radps_ = parameters.wander_radps * counter_gaussian(wander_key_, 0);
  next_.start = kStart;
  if (!parameters.starts_at_rest) {
    steered_radps_ = command.rotor_rate_radps;
    if (command.phase_lock) {
      next_.azimuth_rad = wanted_phase(kStart);
    }
    next_.rate_radps = shaft_rate(next_.azimuth_rad);
  }
  act();
}

void Rotor::command(SimTime time, const LidarCommand& command) {
  check(command);
  (void)at(time);
  command_ = command;
}

RotorState Rotor::at(SimTime time) {
  while (time >= next_.start) {
    act();
  }
  // Constant acceleration within a stretch: azimuth is quadratic in time.
  const double age_s = to_seconds(time - stretch_.start);
  const double azimuth_rad = back_into_turn(
      stretch_.azimuth_rad + age_s * (stretch_.rate_radps + 0.5 * age_s * acceleration_radps2_));
  const double rate_radps = stretch_.rate_radps + age_s * acceleration_radps2_;
  if (parameters_.encoder_noise_rad == 0.0) {
    return {azimuth_rad, rate_radps, azimuth_rad};
  }
  const double noise_rad =
      unsteadiness(rate_radps) * parameters_.encoder_noise_rad *
      counter_gaussian(encoder_key_, static_cast<std::uint64_t>((time - kStart).count()));
  return {azimuth_rad, rate_radps, back_into_turn(azimuth_rad + noise_rad)};
}

double Rotor::wanted_phase(SimTime time) const {
  Duration age = (time - command_.phase_lock->pulse) % kPulsePeriod;
  if (age < Duration::zero()) {
    age += kPulsePeriod;
  }
  return within_turn(command_.phase_lock->azimuth_rad +
                     command_.rotor_rate_radps * to_seconds(age));
}

double Rotor::wanted_rate() const {
  const double commanded = command_.rotor_rate_radps;
  if (!command_.phase_lock || commanded == 0.0) {
    return commanded;
  }
  // Phase lock: proportional to the phase's error, within a share of the speed.
  const double error_rad =
      std::remainder(wanted_phase(stretch_.start) - stretch_.azimuth_rad, kTurn);
  const double most = parameters_.phase_speed_share * std::abs(commanded);
  return commanded + std::clamp(error_rad / parameters_.phase_time_s, -most, most);
}

/// With wander and ripple, which do not turn it round.
double Rotor::shaft_rate(double azimuth_rad) const {
  const double off_radps =
      wander_radps_ + parameters_.ripple_radps * std::cos(azimuth_rad - ripple_phase_rad_);
  const double rate = steered_radps_ + unsteadiness(steered_radps_) * off_radps;
  return steered_radps_ >= 0.0 ? std::max(rate, 0.0) : std::min(rate, 0.0);
}

void Rotor::act() {
  stretch_ = next_;
  const double wanted = wanted_rate();
  const double most = parameters_.acceleration_radps2 * kPeriod_s;
  // Motor: first-order lag, exact over the stretch, with limited acceleration.
  const double lack = wanted - steered_radps_;
  const double share = -std::expm1(-kPeriod_s / parameters_.time_constant_s);
  steered_radps_ = std::abs(lack) < std::min(kSameRate_radps, most)
                       ? wanted
                       : steered_radps_ + std::clamp(share * lack, -most, most);
  if (parameters_.wander_radps > 0.0) {
    // Gauss-Markov wander, exact: e w + sigma sqrt(1 - e^2) n.
    const double kept = std::exp(-kPeriod_s / parameters_.wander_correlation_s);
    wander_radps_ = kept * wander_radps_ + parameters_.wander_radps * std::sqrt(1.0 - kept * kept) *
                                               counter_gaussian(wander_key_, ++draws_);
  }
  next_.start = stretch_.start + kPeriod;
  next_.rate_radps = shaft_rate(stretch_.azimuth_rad + kPeriod_s * stretch_.rate_radps);
  next_.azimuth_rad = back_into_turn(stretch_.azimuth_rad +
                                     0.5 * kPeriod_s * (stretch_.rate_radps + next_.rate_radps));
  acceleration_radps2_ = (next_.rate_radps - stretch_.rate_radps) / kPeriod_s;
}

}  // namespace rigwire::sim
