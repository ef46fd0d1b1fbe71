#pragma once

#include <vector>

#include "emulators/supply.h"

namespace rigwire::test {

/// A supply that fails at those instants.
inline std::vector<emulators::SupplyFault> cuts(const std::vector<Duration>& at,
                                                Duration off = std::chrono::milliseconds{500}) {
  std::vector<emulators::SupplyFault> faults;
  for (const Duration cut : at) {
    faults.push_back({{cut, off}, emulators::NoSupplyFault{}});
  }
  return faults;
}

}  // namespace rigwire::test
