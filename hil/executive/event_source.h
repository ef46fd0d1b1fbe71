// Something that happens in simulated time: a station, a bus, a Modbus line.
//
// On the wire thread only. advance() must move next_event() beyond the instant that it was given: a
// source that does not ends the run.
#pragma once

#include "sim/samples/time.h"

namespace rigwire::hil {

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

}  // namespace rigwire::hil
