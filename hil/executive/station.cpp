#include "hil/executive/station.h"

namespace rigwire::hil {

void Station::collect(StationIndex self, Shelves& requests) {
  const SamplePlan plan = device_.sample_plan();
  if (plan != announced_plan_) {
    announced_plan_ = plan;
    requests.of<SamplePlan>(self).push_back(plan);
  }
}

}  // namespace rigwire::hil
