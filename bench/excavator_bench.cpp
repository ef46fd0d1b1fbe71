#include "bench/excavator_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/published_arm.h"
#include "hil/executive/cpu_time.h"
#include "sim/excavator/excavator.h"

namespace rigwire::bench {
namespace {

using sim::ArmState;
using sim::DrivenArm;
using sim::JointVector;

constexpr double kGrid_s = 0.02;
constexpr int kGridPoints = 200;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kReferenceOrder = 4;

/// States on the 20 ms grid; the last is the one at 4 s.
std::vector<JointVector> run(const DrivenArm& arm, int order, int steps_per_point) {
  const CosineTargets targets(arm);
  const double h = kGrid_s / steps_per_point;
  ArmState state{kPublishedPose, JointVector::Zero()};
  std::vector<JointVector> points;
  points.reserve(kGridPoints);
  long step = 0;
  for (int point = 0; point < kGridPoints; ++point) {
    for (int i = 0; i < steps_per_point; ++i, ++step) {
      step_arm(arm, order, static_cast<double>(step) * h, h, targets, state);
    }
    points.push_back(state.q_rad);
  }
  return points;
}

int steps_per_point(double step_s) {
  const double count = kGrid_s / step_s;
  if (!(step_s > 0.0) || std::abs(count - std::round(count)) > 1e-6 || count < 0.5) {
    throw std::invalid_argument(
        fmt::format("work precision: step {} s does not divide {} s", step_s, kGrid_s));
  }
  return static_cast<int>(std::lround(count));
}

double median(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

WorkPrecisionRow measure_row(const DrivenArm& arm, double factor, const StepMethod& method,
                             double step_s, int repetitions,
                             const std::vector<JointVector>& reference) {
  WorkPrecisionRow row{.method = method, .stiffness_factor = factor, .step_s = step_s};
  const int per_point = steps_per_point(step_s);
  std::vector<JointVector> points;
  std::vector<double> spans;
  for (int i = 0; i < repetitions; ++i) {
    const double begin = hil::thread_cpu_seconds();
    points = run(arm, method.order, per_point);
    spans.push_back(hil::thread_cpu_seconds() - begin);
  }
  const double span_s = median(spans);
  row.microseconds_per_step = 1e6 * span_s / (kGridPoints * per_point);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double error =
        (arm.dynamics().tip_C(points[i]) - arm.dynamics().tip_C(reference[i])).norm();
    row.diverged = row.diverged || !(error < 1.0);
    row.final_error_m = error;
    row.greatest_error_m = std::max(row.greatest_error_m, error);
  }
  if (row.diverged) {
    row.final_error_m = kInfinity;
    row.greatest_error_m = kInfinity;
  }
  return row;
}

sim::ExcavatorParameters stiffened(double factor) {
  sim::ExcavatorParameters parameters;
  parameters.step_s = 1e-3;
  parameters.drives.swing_stiffness_nmprad *= factor;
  parameters.drives.boom_stiffness_npm *= factor;
  parameters.drives.stick_stiffness_npm *= factor;
  parameters.drives.bucket_stiffness_npm *= factor;
  return parameters;
}

/// What validate() says; empty when it has nothing to say.
std::string refusal_of(const sim::ExcavatorParameters& parameters) {
  try {
    validate(parameters);
    return {};
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
}

/// Openings that move all functions, turning round every 500 ms.
ValveCommand alternating_command(int millisecond) {
  const double sign = (millisecond / 500) % 2 == 0 ? 1.0 : -1.0;
  ValveCommand command;
  command.opening = {0.6 * sign, 0.5 * sign, -0.6 * sign, 0.7 * sign};
  return command;
}

/// Whether the whole machine, moved for 4 s, keeps finite rates that such a machine can have.
bool machine_stays_sound(const sim::ExcavatorParameters& parameters) {
  constexpr double kGreatestRate_radps = 10.0;
  sim::Excavator machine(parameters, Eigen::Isometry3d::Identity());
  for (int i = 0; i < 4000; ++i) {
    machine.command(alternating_command(i));
    machine.step(std::chrono::milliseconds(1));
    if (!machine.finite() ||
        machine.joint_rates_radps().cwiseAbs().maxCoeff() > kGreatestRate_radps) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<WorkPrecisionRow> measure_work_precision(const WorkPrecisionSettings& settings) {
  if (settings.repetitions < 1) {
    throw std::invalid_argument(
        fmt::format("work precision: repetitions: found {}, allowed >= 1", settings.repetitions));
  }
  for (const double step_s : settings.steps_s) {
    (void)steps_per_point(step_s);  // Refuses before anything runs.
  }
  std::vector<WorkPrecisionRow> rows;
  for (const double factor : settings.stiffness_factors) {
    const DrivenArm arm = published_arm(factor);
    const std::vector<JointVector> reference =
        run(arm, kReferenceOrder, steps_per_point(settings.reference_step_s));
    for (const StepMethod& method : kArmMethods) {
      for (const double step_s : settings.steps_s) {
        rows.push_back(measure_row(arm, factor, method, step_s, settings.repetitions, reference));
      }
    }
  }
  return rows;
}

StiffestDrive measure_stiffest_drive() {
  constexpr double kStep_s = 1e-3;
  constexpr double kResolution = 1.01;
  constexpr int kRepetitions = 3;
  StiffestDrive drive{.factor = 1.0};
  double refused = 1e8;
  while (refused > drive.factor * kResolution) {
    const double middle = std::sqrt(drive.factor * refused);
    (refusal_of(stiffened(middle)).empty() ? drive.factor : refused) = middle;
  }
  const DrivenArm arm = published_arm(drive.factor);
  drive.row = measure_row(
      arm, drive.factor, kArmMethods.front(), kStep_s, kRepetitions,
      run(arm, kReferenceOrder, steps_per_point(WorkPrecisionSettings{}.reference_step_s)));
  drive.machine_stable = machine_stays_sound(stiffened(drive.factor));
  drive.refused_factor = 1.02 * drive.factor;
  drive.refusal = refusal_of(stiffened(drive.refused_factor));
  return drive;
}

double reference_pose_error_rad(double reference_step_s) {
  const std::vector<JointVector> points =
      run(published_arm(), kReferenceOrder, steps_per_point(reference_step_s));
  return (points.back() - kSimbodyPose).cwiseAbs().maxCoeff();
}

ExcavatorStepCost measure_excavator_step(int steps, sim::ExcavatorLevel level,
                                         sim::ExcavatorCarrier carrier) {
  if (steps < 1) {
    throw std::invalid_argument(fmt::format("excavator step: found {}, allowed >= 1", steps));
  }
  sim::ExcavatorParameters parameters;
  parameters.level = level;
  parameters.carrier = carrier;
  const sim::Ground ground;
  sim::Excavator machine(parameters, Eigen::Isometry3d::Identity(), &ground);
  std::vector<double> spans_us;
  spans_us.reserve(static_cast<std::size_t>(steps));
  for (int i = 0; i < steps; ++i) {
    machine.command(alternating_command(i));
    const auto begin = std::chrono::steady_clock::now();
    machine.step(std::chrono::milliseconds(1));
    spans_us.push_back(
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
            .count());
  }
  ExcavatorStepCost cost;
  cost.median_us = median(spans_us);
  cost.p999_us = spans_us[spans_us.size() - 1 - spans_us.size() / 1000];
  return cost;
}

}  // namespace rigwire::bench
