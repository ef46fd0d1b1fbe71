// What the executive runs, on the wire thread: sources of events, and outlets of what they emit.
#pragma once

#include <optional>

#include "sim/samples/time.h"

namespace rigwire::hil {

/// Something that happens in simulated time: a station, a bus, a Modbus line. advance() must move
/// next_event() beyond the instant that it was given: a source that does not ends the run.
class EventSource {
 public:
  virtual ~EventSource() = default;

  /// The next instant at which this source has something to do; kNever if none. Events of all
  /// sources are run in order of time, and of position in the rig where times are equal.
  [[nodiscard]] virtual SimTime next_event() const = 0;

  /// The next instant worth waking up for. Samples that merely wait to be taken are no reason: they
  /// are taken in their order at the next wake-up.
  [[nodiscard]] virtual SimTime next_wakeup() const = 0;

  /// Runs everything up to and including `now`.
  virtual void advance(SimTime now) = 0;
};

/// Where units of output wait for their deadlines: what the executive must know of the last step to
/// a wire (hil/wires/outlets.h).
class Outlet {
 public:
  virtual ~Outlet() = default;

  /// When the unit in front is due; kNever if none waits.
  [[nodiscard]] virtual SimTime next_due() const = 0;

  /// Hands over the unit in front; never throws, what is not taken is counted. `lateness` is how
  /// long after its due time; nullopt when free-running. Precondition: next_due() != kNever.
  virtual void transmit_front(std::optional<Duration> lateness) = 0;
};

}  // namespace rigwire::hil
