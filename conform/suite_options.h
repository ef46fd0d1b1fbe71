// What of a suite is run, and who is told.
#pragma once

#include <string>
#include <vector>

namespace rigwire::conform {

struct SuiteOptions {
  std::vector<std::string> wanted;  ///< Identities or their beginnings; empty: all.
  bool writes = false;
  bool robustness = false;  ///< The chapter of that name, which is no conformance.
};

}  // namespace rigwire::conform
