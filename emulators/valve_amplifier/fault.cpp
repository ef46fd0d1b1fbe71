#include "emulators/valve_amplifier/fault.h"

#include <algorithm>

namespace rigwire::emulators {
namespace {

SimTime end_of(const ValveDefect& defect) {
  return defect.duration == Duration{0} ? kNever : kStart + defect.start + defect.duration;
}

}  // namespace

ValveDefectState ValveDefects::at(SimTime now, double supply_voltage_v, double ambient_c) const {
  ValveDefectState state;
  state.supply_voltage_v = supply_voltage_v;
  state.ambient_c = ambient_c;
  for (const ValveDefect& defect : defects_) {
    if (now < kStart + defect.start || now >= end_of(defect)) {
      continue;
    }
    switch (defect.kind) {
      case ValveDefectKind::open_coil:
        state.coil_open[defect.section] = true;
        break;
      case ValveDefectKind::short_circuit:
        state.coil_shorted[defect.section] = true;
        break;
      case ValveDefectKind::stuck_spool:
        state.spool_stuck[defect.section] = true;
        break;
      case ValveDefectKind::sensor_failure:
        state.sensor_lost[defect.section] = true;
        break;
      case ValveDefectKind::connector_off:
        state.coil_open[defect.section] = true;
        state.sensor_lost[defect.section] = true;
        break;
      case ValveDefectKind::supply_voltage:
        state.supply_voltage_v = defect.value;
        break;
      case ValveDefectKind::ambient_temperature:
        state.ambient_c = defect.value;
        break;
    }
  }
  return state;
}

SimTime ValveDefects::next_change(SimTime now) const {
  SimTime next = kNever;
  for (const ValveDefect& defect : defects_) {
    for (const SimTime change : {kStart + defect.start, end_of(defect)}) {
      if (change > now) {
        next = std::min(next, change);
      }
    }
  }
  return next;
}

}  // namespace rigwire::emulators
