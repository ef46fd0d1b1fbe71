// Conditions of a measurement: the machine, the kernel, its load, the compiler and its flags.
#pragma once

#include <array>
#include <string>

namespace rigwire::bench {

struct HostFacts {
  std::string kernel;     ///< "Linux 6.1.0".
  std::string processor;  ///< Name reported by the kernel.
  unsigned cores = 0;     ///< Cores that this process may use.
  std::string compiler;   ///< Name and version.
  std::string flags;      ///< Flags of optimisation and machine.
};
[[nodiscard]] HostFacts host_facts();

/// Returns the number of running or waiting processes, on average over 1, 5 and 15 minutes; zeros
/// if unknown.
[[nodiscard]] std::array<double, 3> load_average();

/// Time that the hypervisor gave to others while this machine wanted to run, all cores since boot,
/// in ticks of the kernel's clock; 0 on bare metal.
[[nodiscard]] double stolen_seconds();

}  // namespace rigwire::bench
