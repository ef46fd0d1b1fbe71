// Whether the clients of a run have taken what was sent to them: for the clock that waits for them.
//
// A wire whose client did not take it in time is given up: it is not waited for again before its
// client takes something. So a client that has stopped costs the patience once.
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
  /// The outlet must outlive it. `name`: of the wire, for people.
  void watch(std::string name, const QueuedOutlet& outlet);

  /// Whether every client that the system tells of, and that is not given up, has taken all.
  [[nodiscard]] bool taken();
  /// Those that have not are given up; their wires' names.
  std::vector<std::string> give_up();

 private:
  struct Wire {
    std::string name;
    const QueuedOutlet* outlet;
    std::uint64_t seen = 0;                 ///< Units that had left when all was taken last.
    std::optional<std::size_t> given_up{};  ///< With so much not taken.
  };
  /// Whether it is to be waited for.
  [[nodiscard]] static bool waits(Wire& wire);

  std::vector<Wire> wires_;
};

}  // namespace rigwire::hil
