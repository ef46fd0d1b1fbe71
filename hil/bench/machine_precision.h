// Speed against error of whole machines: the same machine, the same commands, at several inner
// steps against itself at a fine one.
//
// Integration error only: what a coarser step changes in the machine's own equations. Levels of one
// machine are compared with each other elsewhere; they answer different questions. Error: greatest
// distance, over all links, of a link's origin from the reference's, at the end and over a 20 ms
// grid. Time per step is CPU of one thread, median of several runs, with everything that step()
// does (limits, drive line, look-up of the ground, motion of the links).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/machine.h"

namespace rigwire::hil {

/// One machine at one level with one method, and what it is asked to do.
struct MachineCase {
  std::string machine;
  std::string level;
  std::string method;
  double stiffness_factor = 1.0;  ///< On drives, or tyres and springs.
  /// Throws std::invalid_argument where the machine refuses the step.
  std::function<std::unique_ptr<sim::Machine>(double step_s)> make;
  /// Called every 20 ms with the time since the start.
  std::function<void(sim::Machine& machine, SimTime now)> drive;
  Duration span = std::chrono::seconds(4);
};

struct MachinePrecisionRow {
  double step_s = 0.0;
  std::string refusal;    ///< Why this step is not allowed; the rest is empty then.
  bool diverged = false;  ///< Not finite, or farther than 10 m off; errors are infinite then.
  double final_error_m = 0.0;
  double greatest_error_m = 0.0;
  double microseconds_per_step = 0.0;
};

struct MachinePrecisionSettings {
  /// Each must divide 20 ms.
  std::vector<double> steps_s{1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
  double reference_step_s = 1e-5;
  int repetitions = 3;
};

/// One row per step. Throws std::invalid_argument for a step that does not divide 20 ms.
[[nodiscard]] std::vector<MachinePrecisionRow> measure_machine_precision(
    const MachineCase& machine_case, const MachinePrecisionSettings& settings = {});

}  // namespace rigwire::hil
