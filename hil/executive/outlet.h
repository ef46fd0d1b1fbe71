// Where units of output wait for their deadlines: what the executive must know of the last step to
// a wire (hil/wires/outlets.h).
#pragma once

#include <optional>

#include "sim/samples/time.h"

namespace rigwire::hil {

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
