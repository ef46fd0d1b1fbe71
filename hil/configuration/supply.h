// A device's supply: when it comes, and when it fails.
#pragma once

#include <vector>

#include "emulators/supply.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

/// The keys of a device that can lose its supply; to be called within the device's visit().
inline void visit_supply(fields::Visitor& v, emulators::SupplySettings& p) {
  v.duration("power_on", p.power_on, {0, 3'600'000'000'000}, "From the start of the run.");
  std::vector<double> cuts_s;
  for (const Duration cut : p.cuts) {
    cuts_s.push_back(to_seconds(cut));
  }
  v.number_list("power_cycles", cuts_s, fields::in("s").at_least(0),
                "When the supply fails, from the start of the run, rising.");
  p.cuts.clear();
  for (const double cut_s : cuts_s) {
    p.cuts.push_back(from_seconds(cut_s));
  }
  v.duration("power_off", p.off, {1'000'000, 3'600'000'000'000}, "How long it stays away.");
}

}  // namespace rigwire::emulators
