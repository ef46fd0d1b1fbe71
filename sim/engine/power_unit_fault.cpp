#include "sim/engine/power_unit_fault.h"

namespace rigwire::sim {

using fields::in;

void visit(fields::Visitor& v, DerateFault& p) {
  v.number("share", p.share, in("%").between(0, 100),
           "Share of the engine's greatest torque that is left.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, WeakPumpsFault& p) {
  v.number("share", p.share, in("%").between(0, 100),
           "Share of the flow that the pumps still deliver at the same speed.");
  visit_ramp(v, p.ramp);
}

PowerUnitDefects defects_at(SimTime time, const FaultBook<EngineFault>& engine,
                            const FaultBook<PumpFault>& pumps) {
  PowerUnitDefects defects;
  defects.fuel = engine.first<NoFuelFault>(time) == nullptr;
  if (const auto derated = engine.first_grown<DerateFault>(time)) {
    defects.torque_share = derated->share;
  }
  if (const auto weak = pumps.first_grown<WeakPumpsFault>(time)) {
    defects.flow_share = weak->share;
  }
  return defects;
}

}  // namespace rigwire::sim
