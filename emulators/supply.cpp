#include "emulators/supply.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::in;

void visit(fields::Visitor& v, SupplySettings& p) {
  v.duration("power_on", p.power_on, {0, 3'600'000'000'000},
             "When the supply comes, from the start of the run.");
  std::vector<double> cuts_s;
  for (const Duration cut : p.cuts) {
    cuts_s.push_back(to_seconds(cut));
  }
  v.number_list("power_cycles", cuts_s, in("s").above(0),
                "When the supply fails, from the start of the run, rising.");
  p.cuts.clear();
  for (const double cut_s : cuts_s) {
    p.cuts.push_back(from_seconds(cut_s));
  }
  v.duration("power_off", p.off, {1'000'000, 3'600'000'000'000},
             "How long the supply stays away when it fails.");
}

void validate(const SupplySettings& settings) {
  fields::check(settings);
  Duration free = settings.power_on;
  for (const Duration cut : settings.cuts) {
    if (cut <= free) {
      throw std::invalid_argument("power_cycles has " + std::to_string(cut.count()) +
                                  " ns, allowed is later than " + std::to_string(free.count()) +
                                  " ns, when the supply is back");
    }
    free = cut + settings.off;
  }
}

std::vector<SupplyFault> SupplySettings::faults() const {
  std::vector<SupplyFault> faults;
  for (const Duration cut : cuts) {
    faults.push_back({{cut, off}, NoSupplyFault{}});
  }
  return faults;
}

Supply::Supply(const SupplySettings& settings)
    : power_on_(kStart + settings.power_on), book_(settings.faults()) {
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
