#include "emulators/supply.h"

#include <algorithm>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

void visit(fields::Visitor& v, SupplySettings& p) {
  v.duration("power_on", p.power_on, {0, 86'400'000'000'000},
             "When the supply comes, from the start of the run.");
}

void validate(const SupplySettings& settings) {
  fields::check(settings);
  for (const SupplyFault& fault : settings.faults) {
    fields::check(fault);
  }
}

Supply::Supply(const SupplySettings& settings)
    : power_on_(kStart + settings.power_on), book_(settings.faults) {
  find_next(power_on_);
}

void Supply::change() {
  on_ = !on_;
  changed_ = next_;
  find_next(changed_);
}

FaultBook<SupplyFault>::Id Supply::begin(const SupplyFault& fault) {
  fields::check(fault);
  const auto id = book_.add(fault);
  find_next(std::max(changed_, power_on_));
  return id;
}

bool Supply::end(FaultBook<SupplyFault>::Id id, SimTime now) {
  const bool ended = book_.end(id, now);
  find_next(std::max(changed_, power_on_));
  return ended;
}

void Supply::find_next(SimTime from) {
  next_ = book_.next_turn<NoSupplyFault>(from, !on_);
}

}  // namespace rigwire::emulators
