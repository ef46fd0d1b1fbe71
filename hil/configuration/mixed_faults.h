// A list of faults in a rig's file that are acted out in several places: the signals' and the
// device's of a satellite receiver.
#pragma once

#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sim/samples/fault_book.h"

namespace rigwire::hil {

template <class First, class Second>
struct EitherOf;
template <class... First, class... Second>
struct EitherOf<std::variant<First...>, std::variant<Second...>> {
  using Type = std::variant<First..., Second...>;
};

template <class What, class Variant>
inline constexpr bool kIsAlternative = false;
template <class What, class... All>
inline constexpr bool kIsAlternative<What, std::variant<All...>> = (std::is_same_v<What, All> ||
                                                                    ...);

/// A fault of one of two kinds.
template <class First, class Second>
struct MixedFault {
  FaultPeriod when;
  typename EitherOf<decltype(First::what), decltype(Second::what)>::Type what;
};

template <class First, class Second>
void visit(fields::Visitor& v, MixedFault<First, Second>& p) {
  visit_fault(v, p);
}

/// Those of the list that are of kind `Fault`, in its order.
template <class Fault, class Mixed>
[[nodiscard]] std::vector<Fault> those_of(const std::vector<Mixed>& list) {
  std::vector<Fault> result;
  for (const Mixed& mixed : list) {
    std::visit(
        [&]<class What>(const What& what) {
          if constexpr (kIsAlternative<What, decltype(Fault::what)>) {
            result.push_back({mixed.when, what});
          }
        },
        mixed.what);
  }
  return result;
}

}  // namespace rigwire::hil
