// Higher order out of a step of first order: extrapolation of the linearly implicit Euler rule.
//
// Where nothing kinks, what a span costs in error is a power series in the step's length
// (P. Deuflhard, SIAM Review 27 (1985) 505; E. Hairer and G. Wanner, Solving Ordinary Differential
// Equations II, section IV.9). The same span in 1, 2 .. k parts therefore goes through the scheme
// of Aitken and Neville,
//
//     T(j,1) = result in j parts,    T(j,i+1) = T(j,i) + (T(j,i) - T(j-1,i)) / (j / (j-i) - 1),
//
// and T(k,k) is of order k. At a limit that is reached or left the series ends, and with it the
// order.
#pragma once

#include <array>
#include <type_traits>

namespace rigwire::bench {

/// A way to step a machine; order 1 is its own.
struct StepMethod {
  const char* name = "";
  int order = 1;
};

inline constexpr int kExtrapolationMax = 6;

/// T(order, order) of in_parts(1) .. in_parts(order). What in_parts returns can be default made,
/// added and scaled: a double, a plain Eigen matrix. Precondition: order is 1 .. kExtrapolationMax.
template <class InParts>
[[nodiscard]] auto extrapolated(int order, InParts in_parts) {
  using Result = std::invoke_result_t<InParts, int>;
  std::array<Result, kExtrapolationMax> row;  // T(j,1) .. T(j,j).
  for (int j = 1; j <= order; ++j) {
    Result found = in_parts(j);
    for (int i = 1; i < j; ++i) {
      Result& before = row[static_cast<std::size_t>(i) - 1];
      const double share = 1.0 / (static_cast<double>(j) / (j - i) - 1.0);
      const Result next = found + share * (found - before);
      before = found;
      found = next;
    }
    row[static_cast<std::size_t>(j) - 1] = found;
  }
  return row[static_cast<std::size_t>(order) - 1];
}

}  // namespace rigwire::bench
