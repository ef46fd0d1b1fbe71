// Speed against error of whole machines: the same machine with the same commands at several inner
// steps, compared with itself at a fine step.
//
// Two methods: the machine's own step, and the extrapolation of its links' poses to second order
// (extrapolated_step.h) from a run with that step and one with half of it. The reference is the
// latter at a fine step.
//
// The error is the integration error only: the effect of a coarser step or of the other method on
// the machine's own equations. machine_distance() measures the effect of another level or
// parameter. Error: distance of a link's origin from the reference's, the maximum over all links,
// at the end and over a 20 ms grid. Commands change on that grid only, so that every step sees the
// same ones.
//
// Time per step is CPU of one thread, median of several runs, called 20 ms at a time, with
// everything that step() does (limits, drive line, look-up of a plane ground, motion of the links).
// Creating the machine, including any settling before time 0, is not counted.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/extrapolated_step.h"
#include "sim/machine.h"

namespace rigwire::bench {

inline constexpr std::array kMachineMethods{StepMethod{"linearly_implicit_euler", 1},
                                            StepMethod{"extrapolated_2", 2}};

/// One machine at one level, and what it is asked to do.
struct MachineCase {
  std::string machine;
  std::string level;
  std::string scene;              ///< "smooth", or "switches": limits, and friction that breaks
                                  ///< away.
  double stiffness_factor = 1.0;  ///< On drives, or on tyres and springs.
  /// Throws std::invalid_argument where the machine refuses the step.
  std::function<std::unique_ptr<sim::Machine>(double step_s)> make;
  /// Called every 20 ms with the time since the start.
  std::function<void(sim::Machine& machine, SimTime now)> drive;
  Duration span = std::chrono::seconds(3);  ///< A multiple of 20 ms.
};

struct MachinePrecisionRow {
  std::string method;
  double step_s = 0.0;
  std::string refusal;    ///< Why this step is not allowed; the rest is empty then.
  bool diverged = false;  ///< Not finite, or farther than 10 m off; errors are infinite then.
  double final_error_m = 0.0;
  double greatest_error_m = 0.0;
  double microseconds_per_step = 0.0;
};

struct MachinePrecision {
  /// Maximum distance of the reference from that with twice its step: in smooth motion three times
  /// its own error. Errors close to it are not meaningful.
  double reference_gap_m = 0.0;
  std::vector<MachinePrecisionRow> rows;  ///< Method by method, steps as asked for.
};

struct MachinePrecisionSettings {
  /// Each must divide 20 ms.
  std::vector<double> steps_s{1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
  double reference_step_s = 2e-5;  ///< At most a fifth of the finest step.
  int most_repetitions = 9;        ///< Timed runs of the short ones; long ones fewer.
};

/// Throws std::invalid_argument for a step that does not divide 20 ms, a reference that is not
/// finer by a factor of 5, a span that is no multiple of 20 ms, and where the reference is refused.
[[nodiscard]] MachinePrecision measure_machine_precision(
    const MachineCase& machine_case, const MachinePrecisionSettings& settings = {});

/// Slope of log(maximum error) over log(step) of one method, least squares over its steps up to 2
/// ms whose error is at least three times the reference's gap; nullopt with fewer than three.
[[nodiscard]] std::optional<double> measured_order(const MachinePrecision& precision,
                                                   const std::string& method);

struct MachineDistance {
  double final_m = 0.0;
  double greatest_m = 0.0;
};

/// Returns the distance between two machines with the same links at the end when both execute the
/// commands of `one`, each by its own step. Not finite when one of them is not. Throws as
/// measure_machine_precision, and std::invalid_argument for machines with different numbers of
/// links or spans.
[[nodiscard]] MachineDistance machine_distance(const MachineCase& one, const MachineCase& other,
                                               double step_s);

/// CPU time of one step of 1 ms of the machine's own, called 1 ms at a time as a rig does; median
/// of five runs, microseconds.
[[nodiscard]] double machine_step_us(const MachineCase& machine_case);

}  // namespace rigwire::bench
