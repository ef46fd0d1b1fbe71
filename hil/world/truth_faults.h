// The port of faults that act in the truth: they go there with the requests of a station, and hold
// from the next slice on at the earliest, as truth is computed ahead.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "hil/configuration/fault_port.h"
#include "hil/executive/executive.h"
#include "hil/executive/station.h"

namespace rigwire::hil {

/// `faults`: those that are there from the start. Both must outlive the port. `refuse` throws
/// std::invalid_argument at one that there cannot be.
template <class Fault>
[[nodiscard]] std::unique_ptr<FaultPort> truth_faults(
    Executive& executive, Station& station, const std::vector<Fault>& faults,
    std::function<void(const Fault&)> refuse = [](const Fault&) {}) {
  using Change = FaultChange<Fault>;
  FaultActs<Fault> acts;
  acts.begin = [&station, refuse = std::move(refuse)](const Fault& fault) {
    refuse(fault);
    station.send(Change{.begin = fault});
  };
  acts.end = [&station](std::uint32_t id, SimTime at) {
    station.send(Change{.begin = {}, .end_of = id, .end_at = at});
    return true;
  };
  acts.soonest = [&executive](SimTime at) { return std::max(at, executive.soonest_request(at)); };
  return make_fault_port<Fault>(faults, std::move(acts));
}

}  // namespace rigwire::hil
