// Speed against error of the excavator's step: the work-precision table.
//
// Scenario: published_arm.h. At stiffness x1 its end pose is known from Simbody to nine digits
// (reference_pose_error_rad). Methods: the arm's own step, linearly implicit Euler, and what
// extrapolation makes of it (extrapolated_step.h).
//
// Integration error only: the same equations, against a run of order 4 with a fine step. Diverged
// runs stay in the table. Time per step is CPU of one thread, median of several runs; state the
// machine and the flags beside the figures.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bench/extrapolated_step.h"
#include "sim/excavator/parameters.h"

namespace rigwire::bench {

inline constexpr std::array kArmMethods{StepMethod{"linearly_implicit_euler", 1},
                                        StepMethod{"extrapolated_2", 2},
                                        StepMethod{"extrapolated_4", 4}};

struct WorkPrecisionRow {
  StepMethod method = kArmMethods.front();
  double stiffness_factor = 1.0;  ///< Factor on the oil's stiffness, damping ratio unchanged.
  double step_s = 0.0;
  double final_error_m = 0.0;     ///< Error of the bucket's tip at 4 s; infinite when diverged.
  double greatest_error_m = 0.0;  ///< Over the reference's 20 ms grid; infinite when diverged.
  double microseconds_per_step = 0.0;
  bool diverged = false;
};

struct WorkPrecisionSettings {
  std::vector<double> stiffness_factors{1.0, 100.0, 1e4};
  /// Each must divide 20 ms.
  std::vector<double> steps_s{1e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
  int repetitions = 5;             ///< Timed runs; the median counts.
  double reference_step_s = 5e-4;  ///< Step of the reference, which is of order 4.
};

/// All methods at all stiffnesses and steps. Takes a few seconds per stiffness with the defaults.
/// Throws std::invalid_argument for a step that does not divide 20 ms or repetitions < 1.
[[nodiscard]] std::vector<WorkPrecisionRow> measure_work_precision(
    const WorkPrecisionSettings& settings = {});

/// How far the reference run at stiffness x1 ends from Simbody's pose, largest joint error in rad.
[[nodiscard]] double reference_pose_error_rad(double reference_step_s = 1e-3);

/// Cost of Excavator::step as the rig runs it: spools, pump, drives, limits and link motion.
struct ExcavatorStepCost {
  double median_us = 0.0;
  double p999_us = 0.0;  ///< A late step is a failure whatever the median.
};
/// Moves all four functions for `steps` steps of 1 ms, on level ground. Wall time of one call each.
[[nodiscard]] ExcavatorStepCost measure_excavator_step(
    int steps = 20000, sim::ExcavatorLevel level = sim::ExcavatorLevel::dynamic,
    sim::ExcavatorCarrier carrier = sim::ExcavatorCarrier::fixed);

/// How stiff the drives may be at a step of 1 ms, and the arm's error and cost there.
struct StiffestDrive {
  double factor = 0.0;     ///< Maximum on all four stiffnesses that validate() allows, to 1 %.
  WorkPrecisionRow row{};  ///< At that factor and 1 ms.
  /// The whole machine, moved for 4 s there, keeps finite joint rates below 10 rad/s.
  bool machine_stable = false;
  double refused_factor = 0.0;  ///< 2 % above: what validate() says to it
  std::string refusal{};        ///< is this.
};
[[nodiscard]] StiffestDrive measure_stiffest_drive();

}  // namespace rigwire::bench
