#include "emulators/valve_amplifier/fault.h"

namespace rigwire::emulators {

using fields::in;
using fields::IntegerRule;

namespace {

struct Add {
  ValveDefectState& state;

  void operator()(const OpenCoilDefect& p) const { state.coil_open[p.section] = true; }
  void operator()(const ShortedCoilDefect& p) const { state.coil_shorted[p.section] = true; }
  void operator()(const StuckSpoolDefect& p) const { state.spool_stuck[p.section] = true; }
  void operator()(const LostSensorDefect& p) const { state.sensor_lost[p.section] = true; }
  void operator()(const ConnectorOffDefect& p) const {
    state.coil_open[p.section] = true;
    state.sensor_lost[p.section] = true;
  }
  void operator()(const SupplyVoltageDefect& p) const { state.supply_voltage_v = p.value_v; }
  void operator()(const AmbientTemperatureDefect& p) const { state.ambient_c = p.value_c; }
};

}  // namespace

void visit(fields::Visitor& v, SectionDefect& p) {
  std::size_t section_from_1 = p.section + 1;
  v.integer("section", section_from_1, IntegerRule{1, static_cast<std::int64_t>(kValveSections)},
            "The section that has the fault, from 1.");
  p.section = section_from_1 - 1;
}

void visit(fields::Visitor& v, SupplyVoltageDefect& p) {
  v.number("value", p.value_v, in("V").between(0, 60), "Voltage of the supply meanwhile.");
}

void visit(fields::Visitor& v, AmbientTemperatureDefect& p) {
  v.number("value", p.value_c, in("degC").between(-60, 200),
           "Temperature around the driver meanwhile.");
}

void visit(fields::Visitor& v, ValveDefect& p) {
  visit_fault(v, p);
}

std::optional<std::size_t> section_of(const ValveDefect& defect) {
  return std::visit(
      []<class What>(const What& what) -> std::optional<std::size_t> {
        if constexpr (std::is_base_of_v<SectionDefect, What>) {
          return what.section;
        } else {
          return std::nullopt;
        }
      },
      defect.what);
}

ValveDefectState defect_state(const ValveDefects& defects, SimTime now, double supply_voltage_v,
                              double ambient_c) {
  ValveDefectState state;
  state.supply_voltage_v = supply_voltage_v;
  state.ambient_c = ambient_c;
  defects.each(now, [&](const ValveDefect& defect) { std::visit(Add{state}, defect.what); });
  return state;
}

}  // namespace rigwire::emulators
