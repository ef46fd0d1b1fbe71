#include "bench/excavator_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "hil/executive/cpu_time.h"
#include "sim/excavator/driven_arm.h"
#include "sim/excavator/excavator.h"

namespace rigwire::bench {
namespace {

using sim::ArmState;
using sim::DrivenArm;
using sim::IntegrationScheme;
using sim::JointVector;

constexpr double kGrid_s = 0.02;
constexpr int kGridPoints = 200;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr IntegrationScheme kSchemes[] = {IntegrationScheme::linearly_implicit_euler,
                                          IntegrationScheme::rosenbrock2,
                                          IntegrationScheme::runge_kutta4};

const JointVector kStart(0.0, 0.35, -1.4, 0.6);

class CosineTargets final : public sim::TargetMotion {
 public:
  explicit CosineTargets(const DrivenArm& arm) {
    JointVector lever;
    arm.coordinates(kStart, start_, lever);
  }
  void at(double time_s, JointVector& target, JointVector& rate) const override {
    constexpr double kFrequency_hz[] = {0.15, 0.2, 0.25, 0.3};
    constexpr double kAmplitude[] = {0.8, -0.35, 0.5, 0.2};
    for (int i = 0; i < sim::kArmJoints; ++i) {
      const double w = 2.0 * std::numbers::pi * kFrequency_hz[i];
      target[i] = start_[i] + 0.5 * kAmplitude[i] * (1.0 - std::cos(w * time_s));
      rate[i] = 0.5 * kAmplitude[i] * w * std::sin(w * time_s);
    }
  }

 private:
  JointVector start_;
};

DrivenArm arm_with_stiffness(double factor) {
  sim::ExcavatorParameters parameters;
  parameters.bucket_linkage.lug_angle_rad = 0.0;
  parameters.bucket.center_of_mass_m = {0.60, 0.0, -0.20};
  parameters.initial = {kStart[0], kStart[1], kStart[2], kStart[3]};
  DrivenArm arm(parameters, {0.0, 0.0, -9.81});
  arm.gains.stiffness *= factor;
  arm.gains.damping *= std::sqrt(factor);
  return arm;
}

/// States on the 20 ms grid; the last is the one at 4 s.
std::vector<JointVector> run(const DrivenArm& arm, IntegrationScheme scheme, int steps_per_point) {
  const CosineTargets targets(arm);
  const double h = kGrid_s / steps_per_point;
  ArmState state{kStart, JointVector::Zero()};
  std::vector<JointVector> points;
  points.reserve(kGridPoints);
  long step = 0;
  for (int point = 0; point < kGridPoints; ++point) {
    for (int i = 0; i < steps_per_point; ++i, ++step) {
      arm.step(scheme, static_cast<double>(step) * h, h, targets, state);
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

/// Runge-Kutta 4 must stay well inside its stability limit, which shrinks with the frequency.
std::vector<JointVector> reference_run(const DrivenArm& arm, double factor, double step_s) {
  const double finer = std::max(1.0, std::sqrt(factor) / 10.0);
  return run(arm, IntegrationScheme::runge_kutta4,
             static_cast<int>(std::ceil(finer * kGrid_s / step_s - 1e-9)));
}

WorkPrecisionRow measure_row(const DrivenArm& arm, double factor, IntegrationScheme scheme,
                             double step_s, int repetitions,
                             const std::vector<JointVector>& reference) {
  WorkPrecisionRow row{.scheme = scheme, .stiffness_factor = factor, .step_s = step_s};
  const int per_point = steps_per_point(step_s);
  std::vector<JointVector> points;
  std::vector<double> spans;
  for (int i = 0; i < repetitions; ++i) {
    const double begin = hil::thread_cpu_seconds();
    points = run(arm, scheme, per_point);
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

sim::ExcavatorParameters stiffened(IntegrationScheme scheme, double factor) {
  sim::ExcavatorParameters parameters;
  parameters.scheme = scheme;
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
    const DrivenArm arm = arm_with_stiffness(factor);
    const std::vector<JointVector> reference =
        reference_run(arm, factor, settings.reference_step_s);
    for (const IntegrationScheme scheme : kSchemes) {
      for (const double step_s : settings.steps_s) {
        rows.push_back(measure_row(arm, factor, scheme, step_s, settings.repetitions, reference));
      }
    }
  }
  return rows;
}

std::vector<StiffestDrive> measure_stiffest_drives() {
  constexpr double kStep_s = 1e-3;
  constexpr double kLeast = 1e-4;
  constexpr double kGreatest = 1e8;
  constexpr double kResolution = 1.01;
  constexpr int kRepetitions = 3;
  std::vector<StiffestDrive> drives;
  for (const IntegrationScheme scheme : kSchemes) {
    StiffestDrive drive{.scheme = scheme};
    double refused = kGreatest;
    if (refusal_of(stiffened(scheme, kLeast)).empty()) {
      double allowed = kLeast;
      while (refused > allowed * kResolution) {
        const double middle = std::sqrt(allowed * refused);
        (refusal_of(stiffened(scheme, middle)).empty() ? allowed : refused) = middle;
      }
      drive.factor = allowed;
      const DrivenArm arm = arm_with_stiffness(allowed);
      drive.row =
          measure_row(arm, allowed, scheme, kStep_s, kRepetitions,
                      reference_run(arm, allowed, WorkPrecisionSettings{}.reference_step_s));
      drive.machine_stable = machine_stays_sound(stiffened(scheme, allowed));
      drive.refused_factor = 1.02 * allowed;
    } else {
      drive.refused_factor = kLeast;
    }
    drive.refusal = refusal_of(stiffened(scheme, drive.refused_factor));
    drives.push_back(drive);
  }
  return drives;
}

double reference_pose_error_rad(double reference_step_s) {
  const JointVector simbody(0.736274963, 0.176523521, -1.399930624, 0.357101577);
  const std::vector<JointVector> points = run(
      arm_with_stiffness(1.0), IntegrationScheme::runge_kutta4, steps_per_point(reference_step_s));
  return (points.back() - simbody).cwiseAbs().maxCoeff();
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

const char* name_of(IntegrationScheme scheme) {
  switch (scheme) {
    case IntegrationScheme::rosenbrock2:
      return "rosenbrock2";
    case IntegrationScheme::runge_kutta4:
      return "runge_kutta4";
    case IntegrationScheme::linearly_implicit_euler:
      break;
  }
  return "linearly_implicit_euler";
}

}  // namespace rigwire::bench
