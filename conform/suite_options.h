// Options that select the cases of a suite to run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conform/conformance_case.h"

namespace rigwire::conform {

struct SuiteOptions {
  std::vector<std::string> wanted;  ///< Identities or their beginnings; empty: all.
  bool writes = false;
  bool robustness = false;  ///< The chapter of that name, which is no conformance.
  bool moves = false;       ///< Cases by which a machine may move, or a device be lost.
};

/// Returns the skip result of a case that cannot run, or nullopt. `missing` is what the device does
/// not claim, or empty.
[[nodiscard]] std::optional<CaseResult> hindrance(const CaseIdentity& identity,
                                                  const std::string& missing,
                                                  const SuiteOptions& options);

}  // namespace rigwire::conform
