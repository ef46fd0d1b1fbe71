// What goes wrong with the engine of a machine and with the pumps that it drives.
//
//   faults:
//     - {on: machine.engine, type: derate, at: 20 s, for: 30 s, share: 40 %, ramp: 5 s}
//     - {on: machine.pumps, type: weak, at: 60 s, share: 30 %}
//
// They hold from the first step of the physics that does not begin before them. Starting is not
// modelled: an engine that gets fuel again runs up by itself. A machine whose engine drives wheels
// or drums has engine faults alone.
#pragma once

#include <variant>

#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::sim {

struct NoFuelFault {
  static constexpr fields::Named kNamed{"off", "The engine gets no fuel and runs down."};
};
struct DerateFault {
  static constexpr fields::Named kNamed{"derate", "The engine gives a share of its torque."};

  double share = 0.5;  ///< Share of the reference torque.
  Duration ramp{0};

  void grow(double of_it) { share = 1.0 - of_it * (1.0 - share); }
};
inline void visit(fields::Visitor&, NoFuelFault&) {}
void visit(fields::Visitor& v, DerateFault& p);

struct EngineFault {
  FaultPeriod when;
  std::variant<NoFuelFault, DerateFault> what;
};
inline void visit(fields::Visitor& v, EngineFault& p) {
  visit_fault(v, p);
}

struct WeakPumpsFault {
  static constexpr fields::Named kNamed{"weak", "The pumps deliver a share of their flow."};

  double share = 0.5;
  Duration ramp{0};

  void grow(double of_it) { share = 1.0 - of_it * (1.0 - share); }
};
void visit(fields::Visitor& v, WeakPumpsFault& p);

struct PumpFault {
  FaultPeriod when;
  std::variant<WeakPumpsFault> what;
};
inline void visit(fields::Visitor& v, PumpFault& p) {
  visit_fault(v, p);
}

/// Defects that are active at an instant.
struct PowerUnitDefects {
  bool fuel = true;
  double torque_share = 1.0;  ///< Torque limit, as a share of the reference torque.
  double flow_share = 1.0;    ///< Share of the pumps' flow at the same speed; 1 without pumps.

  friend bool operator==(const PowerUnitDefects&, const PowerUnitDefects&) = default;
};

[[nodiscard]] PowerUnitDefects defects_at(SimTime time, const FaultBook<EngineFault>& engine,
                                          const FaultBook<PumpFault>& pumps);

/// A machine whose engine, and pumps if it drives pumps, can fail.
class PowerUnitDefectPort {
 public:
  virtual ~PowerUnitDefectPort() = default;
  /// Sets the defects; they hold until the next call.
  virtual void fail(const PowerUnitDefects& defects) = 0;
};

}  // namespace rigwire::sim
