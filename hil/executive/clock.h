// Wall time to simulation time, for the real-time and scaled modes.
//
// A PacedClock is a pure map between a monotonic wall time, which the caller reads and passes in,
// and simulation time: sim = (wall - start) * factor - slipped. Deadlines are absolute, never sums
// of sleeps. The free-running mode has no clock: there simulated time is as far as it has been
// computed.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "sim/samples/time.h"

namespace rigwire::hil {

using WallTime = std::chrono::steady_clock::time_point;

/// How simulated time relates to wall time.
struct ClockMode {
  enum class Kind { real, free, scaled };
  Kind kind = Kind::real;
  double factor = 1.0;  ///< Simulated seconds per wall second; 1 when real, meaningless when free.

  friend bool operator==(const ClockMode&, const ClockMode&) = default;
};

/// "real", "free" or "scaled:X" with 0.01 <= X <= 1000; nullopt for anything else.
[[nodiscard]] std::optional<ClockMode> parse_clock_mode(std::string_view text);
[[nodiscard]] std::string to_string(const ClockMode& mode);

class PacedClock {
 public:
  /// Simulation time 0 is at `start`. Precondition: factor > 0.
  PacedClock(WallTime start, double factor);

  [[nodiscard]] SimTime at(WallTime wall) const;
  [[nodiscard]] WallTime wall_of(SimTime instant) const;

  /// Lets simulation time fall back by `lag` against wall time: the answer to a host that stalled,
  /// so that nothing is sent in a burst to catch up. May be called while another thread reads.
  void slip(Duration lag);
  [[nodiscard]] Duration slipped() const { return Duration{slipped_ns_.load()}; }
  [[nodiscard]] double factor() const { return factor_; }

 private:
  WallTime start_;
  double factor_;
  std::atomic<std::int64_t> slipped_ns_{0};
};

}  // namespace rigwire::hil
