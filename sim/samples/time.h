// Simulation time: a strong type, integer nanoseconds since the start of the run.
//
// SimTime counts from the start of the simulation and knows nothing of calendars; calendar.h
// derives GPS time and UTC from it, in that one place. No double ever accumulates time: a double of
// seconds is only made at the edge, for formulas and for printing.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <ratio>

namespace rigwire {

/// Tag of the simulation's time line. It has no now(): clocks are injected (hil/executive/clock.h).
struct SimulationClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<SimulationClock>;
  static constexpr bool is_steady = true;
};

/// A span of simulated time, integer nanoseconds.
using Duration = SimulationClock::duration;

/// An instant of simulated time, integer nanoseconds since the start.
using SimTime = SimulationClock::time_point;

/// The start of the run.
inline constexpr SimTime kStart{};

/// Later than every instant that occurs: "nothing is due".
inline constexpr SimTime kNever = SimTime::max();

/// Seconds as a double, for formulas and printing only.
[[nodiscard]] constexpr double to_seconds(Duration span) {
  return static_cast<double>(span.count()) * 1e-9;
}
[[nodiscard]] constexpr double to_seconds(SimTime instant) {
  return to_seconds(instant.time_since_epoch());
}

/// The nearest whole nanosecond. Precondition: |seconds| < 9.2e9 (292 years), finite.
[[nodiscard]] inline Duration from_seconds(double seconds) {
  return Duration{std::llround(seconds * 1e9)};
}

/// The instants at which a device wants its sensor sampled: first + k * period, k = 0, 1, 2, ...
struct SamplePlan {
  SimTime first = kNever;
  Duration period{0};  ///< Greater than zero unless first is kNever.

  friend bool operator==(const SamplePlan&, const SamplePlan&) = default;

  /// The first planned instant that is later than `instant`; kNever without a plan.
  [[nodiscard]] constexpr SimTime next_after(SimTime instant) const {
    if (first == kNever || instant < first) {
      return first;
    }
    const auto passed = (instant - first) / period;
    return first + (passed + 1) * period;
  }
};

}  // namespace rigwire
