// What goes wrong in the program of a node on a bus: it has time for a share of what it sends by
// itself, or it says no to whatever would change it.
//
//   faults:
//     - {type: slow, at: 10 s, for: 5 s, share: 40 %}
//     - {type: refuses, at: 20 s, for: 5 s}
//
// Which messages are periodic, and how a refusal is said, is the device's.
#pragma once

#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct SlowNodeFault {
  static constexpr fields::Named kNamed{"slow",
                                        "Only a share of what the node sends by itself is sent."};

  double share = 0.5;  ///< Share of each message that is sent, spread as evenly as possible.
  Duration ramp{0};

  void grow(double of_it) { share = 1.0 - of_it * (1.0 - share); }
};
struct RefusingNodeFault {
  static constexpr fields::Named kNamed{
      "refuses", "Whatever a client would change is refused and stays as it is."};
};
void visit(fields::Visitor& v, SlowNodeFault& p);
inline void visit(fields::Visitor&, RefusingNodeFault&) {}

struct PaceFault {
  FaultPeriod when;
  std::variant<SlowNodeFault> what;
};
struct RefusalFault {
  FaultPeriod when;
  std::variant<RefusingNodeFault> what;
};
inline void visit(fields::Visitor& v, PaceFault& p) {
  visit_fault(v, p);
}
inline void visit(fields::Visitor& v, RefusalFault& p) {
  visit_fault(v, p);
}

/// Decides which of its messages a slow node has time to send.
class Pace {
 public:
  /// Returns whether the message of that number, due at `now`, is sent. Each message is thinned by
  /// itself: of any n in a row n times the share, to within one, is sent. To be called once for
  /// each message that is due.
  [[nodiscard]] bool has_time(SimTime now, std::uint32_t message);

  FaultBook<PaceFault>::Id begin(const PaceFault& fault) { return faults_.add(fault); }
  /// Ends a fault like FaultBook::end().
  bool end(FaultBook<PaceFault>::Id id, SimTime now) { return faults_.end(id, now); }

 private:
  FaultBook<PaceFault> faults_;
  /// Message number, and messages owed to it.
  std::vector<std::pair<std::uint32_t, double>> owed_;
};

/// When a node refuses what would change it.
class Refusal {
 public:
  [[nodiscard]] bool holds(SimTime now) const {
    return faults_.first<RefusingNodeFault>(now) != nullptr;
  }

  FaultBook<RefusalFault>::Id begin(const RefusalFault& fault) { return faults_.add(fault); }
  /// Ends a fault like FaultBook::end().
  bool end(FaultBook<RefusalFault>::Id id, SimTime now) { return faults_.end(id, now); }

 private:
  FaultBook<RefusalFault> faults_;
};

}  // namespace rigwire::emulators
