#include "emulators/firmware_fault.h"

#include <algorithm>

namespace rigwire::emulators {

void visit(fields::Visitor& v, SlowNodeFault& p) {
  v.number("share", p.share, fields::in("%").above(0).at_most(100),
           "Share of each message that is still sent, spread evenly.");
  visit_ramp(v, p.ramp);
}

bool Pace::has_time(SimTime now, std::uint32_t message) {
  constexpr double kRounding = 1e-9;
  const auto slow = faults_.first_grown<SlowNodeFault>(now);
  if (!slow) {
    owed_.clear();
    return true;
  }
  auto owed = std::ranges::find(owed_, message, &std::pair<std::uint32_t, double>::first);
  if (owed == owed_.end()) {
    owed = owed_.insert(owed, {message, 0.0});
  }
  owed->second += slow->share;
  if (owed->second < 1.0 - kRounding) {
    return false;
  }
  owed->second -= 1.0;
  return true;
}

}  // namespace rigwire::emulators
