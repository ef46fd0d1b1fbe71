#include "hil/bench/excavator_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "sim/excavator/driven_arm.h"
#include "sim/excavator/excavator.h"

namespace rigwire::hil {
namespace {

using sim::ArmState;
using sim::DrivenArm;
using sim::IntegrationScheme;
using sim::JointVector;

constexpr double kSpan_s = 4.0;
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

double cpu_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
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

}  // namespace

std::vector<WorkPrecisionRow> measure_work_precision(const WorkPrecisionSettings& settings) {
  if (settings.repetitions < 1) {
    throw std::invalid_argument(
        fmt::format("work precision: repetitions: found {}, allowed >= 1", settings.repetitions));
  }
  std::vector<WorkPrecisionRow> rows;
  for (const double factor : settings.stiffness_factors) {
    const DrivenArm arm = arm_with_stiffness(factor);
    // Runge-Kutta 4 must stay well inside its stability limit, which shrinks with the frequency.
    const double finer = std::max(1.0, std::sqrt(factor) / 10.0);
    const int reference_steps =
        static_cast<int>(std::ceil(finer * kGrid_s / settings.reference_step_s - 1e-9));
    const std::vector<JointVector> reference =
        run(arm, IntegrationScheme::runge_kutta4, reference_steps);
    for (const IntegrationScheme scheme : kSchemes) {
      for (const double step_s : settings.steps_s) {
        WorkPrecisionRow row{.scheme = scheme, .stiffness_factor = factor, .step_s = step_s};
        const int per_point = steps_per_point(step_s);
        std::vector<JointVector> points;
        std::vector<double> spans;
        for (int i = 0; i < settings.repetitions; ++i) {
          const double begin = cpu_s();
          points = run(arm, scheme, per_point);
          spans.push_back(cpu_s() - begin);
        }
        const double span_s = median(spans);
        row.microseconds_per_step = 1e6 * span_s / (kGridPoints * per_point);
        row.realtime_factor = span_s > 0.0 ? kSpan_s / span_s : kInfinity;
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
        rows.push_back(row);
      }
    }
  }
  return rows;
}

double reference_pose_error_rad(double reference_step_s) {
  const JointVector simbody(0.736274963, 0.176523521, -1.399930624, 0.357101577);
  const std::vector<JointVector> points = run(
      arm_with_stiffness(1.0), IntegrationScheme::runge_kutta4, steps_per_point(reference_step_s));
  return (points.back() - simbody).cwiseAbs().maxCoeff();
}

ExcavatorStepCost measure_excavator_step(int steps) {
  if (steps < 1) {
    throw std::invalid_argument(fmt::format("excavator step: found {}, allowed >= 1", steps));
  }
  sim::Excavator machine(sim::ExcavatorParameters{}, Eigen::Isometry3d::Identity());
  std::vector<double> spans_us;
  spans_us.reserve(static_cast<std::size_t>(steps));
  for (int i = 0; i < steps; ++i) {
    if (i % 500 == 0) {
      const double sign = (i / 500) % 2 == 0 ? 1.0 : -1.0;
      ValveCommand command;
      command.opening = {0.6 * sign, 0.5 * sign, -0.6 * sign, 0.7 * sign};
      machine.command(command);
    }
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

std::string to_text(std::span<const WorkPrecisionRow> rows) {
  std::string text =
      fmt::format("{:<24} {:>9} {:>9} {:>12} {:>12} {:>8} {:>9}\n", "scheme", "stiffness",
                  "step ms", "error 4 s m", "greatest m", "us/step", "real time");
  for (const WorkPrecisionRow& row : rows) {
    fmt::format_to(std::back_inserter(text),
                   "{:<24} {:>9g} {:>9g} {:>12.2e} {:>12.2e} {:>8.2f} {:>8.0f}x\n",
                   name_of(row.scheme), row.stiffness_factor, 1e3 * row.step_s, row.final_error_m,
                   row.greatest_error_m, row.microseconds_per_step, row.realtime_factor);
  }
  return text;
}

}  // namespace rigwire::hil
