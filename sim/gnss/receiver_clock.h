// The clock of a satellite receiver: a cheap crystal without steering, read on a grid of whole
// milliseconds.
//
// Clock and true (GPS) time differ by a bias; its rate is a mean drift plus a first-order
// Gauss-Markov wander. When the bias exceeds its limit the receiver steps its clock by a
// millisecond, so that the bias is a saw tooth. Measurements are taken when the clock shows the
// whole millisecond nearest to the requested instant; so epochs are now and then a millisecond off,
// as the logs of u-blox receivers show (iTOW ends with 999 or 000).
//
// The trajectory is drawn on a grid of whole seconds of simulated time, by the exact discretisation
// of drift and integrated drift, and joined by cubics: it is the same whatever the epochs asked
// for, and the drift is exactly the derivative of the bias.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "fields/rules.h"
#include "sim/random.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

struct ReceiverClockParameters {
  double drift = -4.3e-7;               ///< Mean, s/s; |drift| <= 1e-4. A NEO-7P's log: -4.29e-7.
  double wander_sigma = 2e-9;           ///< s/s; [0, 1e-6].
  double wander_correlation_s = 100.0;  ///< [1, 1e6].
  double bias_limit_s = 1e-3;           ///< Reset beyond it; [5.1e-4, 1e-3].
};
void visit(fields::Visitor& v, ReceiverClockParameters& p);

/// Throws std::invalid_argument naming the key or member, its value and what is allowed.
void validate(const ReceiverClockParameters& parameters);

/// One measurement epoch. Exactly: wanted + label_offset = wanted + measured_after_s + bias_s.
struct ClockEpoch {
  double measured_after_s = 0.0;  ///< By true time; within half a millisecond.
  Duration measured_after{0};     ///< measured_after_s in whole nanoseconds.
  Duration label_offset{0};       ///< What the clock shows, less the wanted time: -1, 0 or 1 ms.
  bool reset = false;             ///< Set by a millisecond since the epoch before.
  double bias_s = 0.0;            ///< Clock less true time, at the measurement.
  double drift = 0.0;             ///< Its rate, s per true second.
};

class ReceiverClock {
 public:
  /// Throws as validate(). The random stream is named `name`.
  ReceiverClock(const ReceiverClockParameters& parameters, std::uint64_t seed,
                std::string_view name);

  /// The measurement nearest to `wanted`, a whole millisecond of GPS time and not earlier than the
  /// one before by more than a second.
  [[nodiscard]] ClockEpoch measure(SimTime wanted);

 private:
  struct Knot {
    double bias_s = 0.0;
    double wander = 0.0;
  };
  struct Reading {
    double bias_s = 0.0;
    double drift = 0.0;
  };
  [[nodiscard]] Knot next(const Knot& knot);
  void reach(std::int64_t second);
  /// -1 <= since_second_s < 2, from second_ on.
  [[nodiscard]] Reading read(double since_second_s) const;

  ReceiverClockParameters parameters_;
  RandomStream random_;
  std::int64_t second_ = 0;    ///< Since the start.
  std::array<Knot, 4> knots_;  ///< At second_ - 1, second_, second_ + 1, second_ + 2.
  std::int64_t resets_ = 0;    ///< Milliseconds taken off the free-running bias.
  bool measured_before_ = false;
};

}  // namespace rigwire::sim
