// Whether the clients of a run have taken what was sent to them: for the clock that waits for them.
//
// A wire whose client did not take it in time is given up: the run does not wait for it again
// before its client takes something. So a client that has stopped costs the patience once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/wires/outlets.h"

namespace rigwire::hil {

class ClientDrain {
 public:
  /// Adds an outlet, which must outlive this. `name`: of the wire, for messages.
  void watch(std::string name, const QueuedOutlet& outlet);

  /// Returns whether every client that the system reports on, and that is not given up, has taken
  /// all.
  [[nodiscard]] bool taken();
  /// Gives up the clients that have not; returns their wires' names.
  std::vector<std::string> give_up();

 private:
  struct Wire {
    std::string name;
    const QueuedOutlet* outlet;
    std::uint64_t seen = 0;                 ///< Units that had left when all was last taken.
    std::optional<std::size_t> given_up{};  ///< Given up, with so much not taken.
  };
  /// Returns whether the run must wait for it.
  [[nodiscard]] static bool waits(Wire& wire);

  std::vector<Wire> wires_;
};

}  // namespace rigwire::hil
