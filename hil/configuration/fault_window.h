// When a fault of a rig's file acts, whatever it does: for the status table, the summary and the
// report.
#pragma once

#include <functional>
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
  std::string type;   ///< Type as in the rig's file: "jamming"; for a node on a bus with its name.
  SimTime begin{};    ///< It acts in [begin, end).
  SimTime end{};      ///< kNever: to the end of the run.
  /// Condition that it waits for: "boom_angle above 0.5". It has no beginning then (kNever).
  std::string waits_for{};

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

[[nodiscard]] FaultWindow fault_window(std::string_view where, std::string name,
                                       const FaultPeriod& when);

/// Seed of what is drawn for the probability of a fault: of that one alone, whatever others there
/// are.
[[nodiscard]] std::uint64_t fault_stream(std::uint64_t seed, std::string_view where,
                                         std::string_view name, Duration at);

/// Is shown a fault of a configuration, whatever it is: when it acts, which it may change, and what
/// it is called.
using FaultEar = std::function<void(FaultPeriod& when, const std::string& name)>;

/// Shows a list of faults; `name(fault)` is what each is called.
template <class Fault, class Name>
void show_faults(std::vector<Fault>& faults, const FaultEar& take, const Name& name) {
  for (Fault& fault : faults) {
    take(fault.when, name(fault));
  }
}
template <class Fault>
void show_faults(std::vector<Fault>& faults, const FaultEar& take) {
  show_faults(faults, take, kind_name<Fault>);
}

// A list of faults in a rig's file that are acted out in several places: the signals' and the
// device's of a satellite receiver.

template <class... Variants>
struct EitherOf;
template <class... All>
struct EitherOf<std::variant<All...>> {
  using Type = std::variant<All...>;
};
template <class... First, class... Second, class... More>
struct EitherOf<std::variant<First...>, std::variant<Second...>, More...>
    : EitherOf<std::variant<First..., Second...>, More...> {};

template <class What, class Variant>
inline constexpr bool kIsAlternative = false;
template <class What, class... All>
inline constexpr bool kIsAlternative<What, std::variant<All...>> = (std::is_same_v<What, All> ||
                                                                    ...);

/// A fault of one of these.
template <class... Fault>
struct MixedFault {
  FaultPeriod when;
  typename EitherOf<decltype(Fault::what)...>::Type what;
};

template <class... Fault>
void visit(fields::Visitor& v, MixedFault<Fault...>& p) {
  visit_fault(v, p);
}

/// The kinds of all of them.
template <class... Fault>
[[nodiscard]] std::vector<fields::Named> mixed_kinds(const std::vector<MixedFault<Fault...>>&) {
  return fault_kinds<Fault...>();
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
