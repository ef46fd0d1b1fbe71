// What this machine can offer a rig, and what to do where it cannot.
#pragma once

#include <string>
#include <vector>

namespace rigwire::hil {

enum class Health {
  good,
  limited,  ///< Rigs run, with a restriction that `detail` names.
  missing   ///< A rig that needs it does not start.
};

struct Finding {
  std::string name;  ///< "AF_CAN", "pty", ...
  Health health = Health::good;
  std::string detail;  ///< What was found.
  std::string fix;     ///< What to do; empty when good.
};

/// Asks the system: CAN sockets, the vcan interface, pseudo-terminals, real-time priority, memory
/// lock, UDP socket buffers, the default ports, the folder of the links, and USB. Changes nothing
/// that outlives the call.
[[nodiscard]] std::vector<Finding> examine_machine();

[[nodiscard]] const char* to_string(Health health);

}  // namespace rigwire::hil
