#include "hil/world/world_sensor.h"

namespace rigwire::hil {

sim::LinkMotion WorldStep::motion(const SensorMount& mount, SimTime time) const {
  return sim::at_mount(
      sim::LinkMotionInterpolation(t0, links_at_t0[mount.link], t1, links_at_t1[mount.link])(time),
      mount.X_LS);
}

void PlannedInstants::take(SimTime frontier, const Shelves& requests) {
  const std::vector<SamplePlan>* plans = requests.find<SamplePlan>(station_);
  if (plans == nullptr || plans->empty()) {
    return;
  }
  plan_ = plans->back();
  next_ = frontier == kStart ? plan_.first : plan_.next_after(frontier);
}

}  // namespace rigwire::hil
