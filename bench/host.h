// What a figure must be read with: the machine, the kernel, its load, the compiler and its flags.
#pragma once

#include <array>
#include <string>

namespace rigwire::bench {

struct HostFacts {
  std::string kernel;     ///< "Linux 6.1.0".
  std::string processor;  ///< As the kernel names it.
  unsigned cores = 0;     ///< That this process may use.
  std::string compiler;   ///< Name and version.
  std::string flags;      ///< Of optimisation and machine.
};
[[nodiscard]] HostFacts host_facts();

/// Processes that ran or waited, on average over 1, 5 and 15 minutes; zeros when not known.
[[nodiscard]] std::array<double, 3> load_average();

/// Time that the hypervisor gave to others while this machine wanted to run, all cores since boot,
/// in ticks of the kernel's clock; 0 on bare metal.
[[nodiscard]] double stolen_seconds();

}  // namespace rigwire::bench
