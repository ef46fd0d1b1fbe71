// Counts this thread's heap allocations, for tests that say "this loop does not allocate".
#pragma once

#include <cstdint>

namespace rigwire::test {

/// Calls of operator new on the calling thread since it started.
[[nodiscard]] std::uint64_t allocations();

}  // namespace rigwire::test
