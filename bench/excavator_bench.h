// Speed against error of the excavator's integration schemes: the work-precision table.
//
// Scenario: the published REF-18t arm (bucket lug on the pin-to-tip line, g = 9.81 m/s2, start
// (0, 0.35, -1.4, 0.6) rad at rest), four Eq. 5 drives with k = (2e6 N m/rad, 4.8e7, 3e7, 1.9e7
// N/m) and damping ratio 0.3, targets moving as 1 - cos for 4 s, no relief and no end stops. At
// stiffness x1 its end pose is known from Simbody to nine digits (reference_pose_error_rad).
//
// Integration error only: the same equations, against a fine-step run of the same code. Diverged
// runs stay in the table. Time per step is CPU of one thread, median of several runs; state the
// machine and the flags beside the figures.
#pragma once

#include <string>
#include <vector>

#include "sim/excavator/parameters.h"

namespace rigwire::bench {

struct WorkPrecisionRow {
  sim::IntegrationScheme scheme = sim::IntegrationScheme::linearly_implicit_euler;
  double stiffness_factor = 1.0;  ///< Times the oil's stiffness, damping ratio unchanged.
  double step_s = 0.0;
  double final_error_m = 0.0;     ///< Of the bucket's tip at 4 s; infinite when diverged.
  double greatest_error_m = 0.0;  ///< Over the reference's 20 ms grid; infinite when diverged.
  double microseconds_per_step = 0.0;
  bool diverged = false;
};

struct WorkPrecisionSettings {
  std::vector<double> stiffness_factors{1.0, 100.0, 1e4};
  /// Each must divide 20 ms.
  std::vector<double> steps_s{1e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
  int repetitions = 5;  ///< Timed runs; the median counts.
  /// Runge-Kutta 4; divided by sqrt(factor) / 10 for factors above 100.
  double reference_step_s = 5e-5;
};

/// All schemes at all stiffnesses and steps. Takes two to four seconds per stiffness with the
/// defaults.
/// Throws std::invalid_argument for a step that does not divide 20 ms or repetitions < 1.
[[nodiscard]] std::vector<WorkPrecisionRow> measure_work_precision(
    const WorkPrecisionSettings& settings = {});

/// How far the reference run at stiffness x1 ends from Simbody's pose, largest joint error in rad.
[[nodiscard]] double reference_pose_error_rad(double reference_step_s = 1e-4);

/// Cost of Excavator::step as the rig runs it: spools, pump, drives, limits and link motion.
struct ExcavatorStepCost {
  double median_us = 0.0;
  double p999_us = 0.0;  ///< A late step is a failure whatever the median.
};
/// Moves all four functions for `steps` steps of 1 ms, on level ground. Wall time of one call each.
[[nodiscard]] ExcavatorStepCost measure_excavator_step(
    int steps = 20000, sim::ExcavatorLevel level = sim::ExcavatorLevel::dynamic,
    sim::ExcavatorCarrier carrier = sim::ExcavatorCarrier::fixed);

/// How stiff the drives may be at a step of 1 ms, and what the scheme makes of it there.
struct StiffestDrive {
  sim::IntegrationScheme scheme = sim::IntegrationScheme::linearly_implicit_euler;
  /// Greatest factor on all four stiffnesses that validate() allows, to 1 %; 0 when it refuses any.
  /// Runge-Kutta 4 also has to carry the end stops, whose stiffness stays.
  double factor = 0.0;
  WorkPrecisionRow row{};  ///< At that factor and 1 ms; meaningless when factor is 0.
  /// The whole machine, moved for 4 s there, keeps finite joint rates below 10 rad/s.
  bool machine_stable = false;
  double refused_factor = 0.0;  ///< 2 % above: what validate() says to it
  std::string refusal{};        ///< is this.
};
[[nodiscard]] std::vector<StiffestDrive> measure_stiffest_drives();

/// "linearly_implicit_euler", "rosenbrock2", "runge_kutta4".
[[nodiscard]] const char* name_of(sim::IntegrationScheme scheme);

}  // namespace rigwire::bench
