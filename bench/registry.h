// The suites of rigwire-bench.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <span>
#include <string_view>

namespace rigwire::bench {

/// One suite. `function` measures, writes its table for people to `text`, and returns the same
/// figures with units in their names. May throw std::exception: the suite failed.
struct BenchSuite {
  std::string_view name;  ///< Name on the command line.
  std::string_view text;  ///< One line for `rigwire-bench --list`.
  nlohmann::json (*function)(std::ostream& text);
};

/// All suites, in the order in which rigwire-bench runs them (bench/registry.cpp).
[[nodiscard]] std::span<const BenchSuite> bench_suites();

}  // namespace rigwire::bench
