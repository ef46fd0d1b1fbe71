#include "emulators/valve_amplifier/fault.h"

#include <algorithm>

#include "fields/visitor.h"

namespace rigwire::emulators {
namespace {

using fields::in;
using fields::IntegerRule;

constexpr std::array<fields::Choice<ValveDefectKind>, 7> kDefects{
    {{ValveDefectKind::open_coil, "open_coil", "A wire of a section's coil is broken."},
     {ValveDefectKind::short_circuit, "short_circuit", "A section's coil is a short circuit."},
     {ValveDefectKind::stuck_spool, "stuck_spool", "A section's spool stays where it is."},
     {ValveDefectKind::sensor_failure, "sensor_failure", "A section's position is not measured."},
     {ValveDefectKind::connector_off, "connector_off",
      "Neither coil nor sensor of a section is connected."},
     {ValveDefectKind::supply_voltage, "supply_voltage", "The supply's voltage is `value`."},
     {ValveDefectKind::ambient_temperature, "ambient_temperature",
      "The temperature around the driver is `value`."}}};

SimTime end_of(const ValveDefect& defect) {
  return defect.duration == Duration{0} ? kNever : kStart + defect.start + defect.duration;
}

}  // namespace

void visit(fields::Visitor& v, ValveDefect& p) {
  std::size_t section_from_1 = p.section + 1;
  v.required("at");
  v.duration("at", p.start, {0, fields::kYear_ns}, "When it begins, from the start of the run.");
  v.duration("for", p.duration, {0, fields::kYear_ns},
             "How long it lasts; 0 = to the end of the run.");
  v.required("type");
  v.choice("type", p.kind, kDefects, "Which fault it is.");
  v.integer("section", section_from_1, IntegerRule{1, static_cast<std::int64_t>(kValveSections)},
            "The section that has the fault, from 1; not of supply and surroundings.");
  switch (p.kind) {
    case ValveDefectKind::supply_voltage:
      v.number("value", p.value, in("V").between(0, 60), "Voltage of the supply meanwhile.");
      break;
    case ValveDefectKind::ambient_temperature:
      v.number("value", p.value, in("degC").between(-60, 200),
               "Temperature around the driver meanwhile.");
      break;
    case ValveDefectKind::open_coil:
    case ValveDefectKind::short_circuit:
    case ValveDefectKind::stuck_spool:
    case ValveDefectKind::sensor_failure:
    case ValveDefectKind::connector_off:
      v.number("value", p.value, fields::plain().between(-60, 200),
               "Without meaning for a fault of a section.");
      break;
  }
  p.section = section_from_1 - 1;
}

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
