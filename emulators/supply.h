// A device's supply: when it comes, and the faults in which there is none.
#pragma once

#include <variant>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct NoSupplyFault {
  static constexpr fields::Named kNamed{"off", "The device has no supply."};
};
inline void visit(fields::Visitor&, NoSupplyFault&) {}

struct SupplyFault {
  FaultPeriod when;
  std::variant<NoSupplyFault> what;
};
inline void visit(fields::Visitor& v, SupplyFault& p) {
  visit_fault(v, p);
}

struct SupplySettings {
  Duration power_on{0};  ///< From the start of the run.
  std::vector<SupplyFault> faults;
};

/// Visits the keys except the faults, which are in one list with others of the device; to be called
/// within the device's visit().
void visit(fields::Visitor& v, SupplySettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const SupplySettings& settings);

/// Off until `power_on`, and then whenever a fault holds.
class Supply {
 public:
  explicit Supply(const SupplySettings& settings);

  [[nodiscard]] bool on() const { return on_; }
  /// Returns when the supply switches next; kNever if it does not switch any more.
  [[nodiscard]] SimTime next_change() const { return next_; }
  /// Switches. To be called at next_change().
  void change();

  [[nodiscard]] const FaultBook<SupplyFault>& book() const { return book_; }
  /// Adds a fault. It begins no earlier than the device was advanced to. Throws
  /// std::invalid_argument.
  FaultBook<SupplyFault>::Id begin(const SupplyFault& fault);
  /// Ends a fault from `now` on. Returns false if there is none of that number or it is over.
  bool end(FaultBook<SupplyFault>::Id id, SimTime now);

 private:
  void find_next(SimTime from);

  SimTime power_on_;
  FaultBook<SupplyFault> book_;
  SimTime changed_ = kStart;  ///< The last change.
  SimTime next_ = kNever;
  bool on_ = false;
};

}  // namespace rigwire::emulators
