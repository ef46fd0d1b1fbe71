// Wall time to simulation time, for the real-time and scaled modes.
//
// A PacedClock is a pure map between a monotonic wall time, which the caller reads and passes in,
// and simulation time: sim = (wall - anchor) * factor + sim at the anchor. Deadlines are absolute,
// never sums of sleeps; the anchor moves only when the clock slips, pauses, or changes its factor.
// The free-running modes have no clock: there simulated time is as far as it has been computed.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "sim/samples/time.h"

namespace rigwire::hil {

using WallTime = std::chrono::steady_clock::time_point;

/// How simulated time relates to wall time.
struct ClockMode {
  enum class Kind {
    real,
    free,    ///< Runs as fast as possible.
    scaled,  ///< Real time, times `factor`.
    /// Runs as fast as possible, but is paused at the start and advances on command only.
    step,
    /// Runs as fast as possible, but waits until clients have taken what was sent (client_drain.h).
    drained,
  };
  Kind kind = Kind::real;
  double factor = 1.0;  ///< Simulated seconds per wall second; 1 unless `kind` is scaled.

  /// Returns whether it follows the wall clock.
  [[nodiscard]] bool paced() const { return kind == Kind::real || kind == Kind::scaled; }

  friend bool operator==(const ClockMode&, const ClockMode&) = default;
};

/// Range of a factor.
inline constexpr double kLeastFactor = 0.01;
inline constexpr double kGreatestFactor = 1000.0;

/// "real", "free", "step", "drained" or "scaled:X" with X within the ends; nullopt for anything
/// else.
[[nodiscard]] std::optional<ClockMode> parse_clock_mode(std::string_view text);
[[nodiscard]] std::string to_string(const ClockMode& mode);

/// Any member may be called while other threads read.
class PacedClock {
 public:
  /// Simulation time 0 is at `start`. Precondition: factor > 0.
  PacedClock(WallTime start, double factor);

  [[nodiscard]] SimTime at(WallTime wall) const;
  /// Returns WallTime::max() for later instants while the clock is paused.
  [[nodiscard]] WallTime wall_of(SimTime instant) const;

  /// Lets simulation time fall back by `lag` against wall time, after a stall of the host, so that
  /// nothing is sent in a burst to catch up.
  void slip(Duration lag);
  [[nodiscard]] Duration slipped() const;

  /// Pauses the clock at `instant`.
  void stand(SimTime instant);
  /// Resumes at `wall` from the instant at which it was paused. No effect while it runs.
  void go_on(WallTime wall);
  /// Changes the pace from `wall` on. Precondition: factor > 0.
  void set_factor(WallTime wall, double factor);
  [[nodiscard]] double factor() const;

 private:
  struct Course {
    WallTime wall;  ///< The anchor.
    SimTime sim;    ///< Simulation time at the anchor.
    double factor;
    bool stands = false;

    [[nodiscard]] SimTime at(WallTime when) const;
    [[nodiscard]] WallTime wall_of(SimTime instant) const;
  };
  [[nodiscard]] Course course() const;

  mutable std::mutex mutex_;
  Course course_;
  Duration slipped_{0};
};

}  // namespace rigwire::hil
