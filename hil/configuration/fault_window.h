// When a fault of a rig's file acts, whatever it does: for the status table, the summary and the
// report.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "sim/samples/fault_book.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct FaultWindow {
  std::string where;  ///< Name of the device; "bus can", "modbus cab".
  std::string type;   ///< As in the rig's file: "jamming"; of a node on a bus with its name.
  SimTime begin{};    ///< It acts in [begin, end).
  SimTime end{};      ///< kNever: to the end of the run.

  [[nodiscard]] bool acts_at(SimTime now) const { return begin <= now && now < end; }

  friend bool operator==(const FaultWindow&, const FaultWindow&) = default;
};

/// The kinds of those structures of fault.
template <class... Fault>
[[nodiscard]] std::vector<fields::Named> fault_kinds() {
  std::vector<fields::Named> kinds;
  const auto add = [&kinds]<class... What>(std::type_identity<std::variant<What...>>) {
    (kinds.push_back(What::kNamed), ...);
  };
  (add(std::type_identity<decltype(Fault::what)>{}), ...);
  return kinds;
}

/// What a fault is called: its kind.
template <class Fault>
[[nodiscard]] std::string kind_name(const Fault& fault) {
  return std::string(fields::chosen_name(fault.what));
}

/// The windows of a list of faults; `name(fault)` is what each is called.
template <class Fault, class Name>
[[nodiscard]] std::vector<FaultWindow> fault_windows(const std::vector<Fault>& faults,
                                                     std::string_view where, const Name& name) {
  std::vector<FaultWindow> windows;
  for (const Fault& fault : faults) {
    windows.push_back({std::string(where), name(fault), fault.when.begin(), fault.when.end()});
  }
  return windows;
}
template <class Fault>
[[nodiscard]] std::vector<FaultWindow> fault_windows(const std::vector<Fault>& faults,
                                                     std::string_view where) {
  return fault_windows(faults, where, kind_name<Fault>);
}

// A list of faults in a rig's file that are acted out in several places: the signals' and the
// device's of a satellite receiver.

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
