#include "hil/bench/registry.h"

namespace rigwire::hil {

std::span<const BenchSuite> bench_suites() {
  return {};
}

}  // namespace rigwire::hil
