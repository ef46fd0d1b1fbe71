#include "bench/machine_precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hil/executive/cpu_time.h"

namespace rigwire::bench {
namespace {

constexpr Duration kGrid = std::chrono::milliseconds(20);
constexpr double kLost_m = 10.0;

/// Origins of all links, grid point after grid point.
using Trace = Eigen::Matrix3Xd;

struct Run {
  Trace trace;
  std::size_t links = 0;
  double cpu_s = 0.0;
  bool finite = true;
};

/// The machine's own step, `call` at a time.
Run run(const MachineCase& of, double step_s, Duration call = kGrid) {
  Run result;
  const auto machine = of.make(step_s);
  result.links = machine->links().size();
  const auto points = static_cast<std::size_t>(of.span / kGrid);
  const auto calls = static_cast<int>(kGrid / call);
  result.trace.resize(3, static_cast<Eigen::Index>(points * result.links));
  Eigen::Index place = 0;
  for (std::size_t i = 0; i < points; ++i) {
    of.drive(*machine, SimTime{static_cast<int>(i) * kGrid});
    const double begin_s = hil::thread_cpu_seconds();
    for (int k = 0; k < calls; ++k) {
      machine->step(call);
    }
    result.cpu_s += hil::thread_cpu_seconds() - begin_s;
    for (const sim::LinkMotion& link : machine->links()) {
      result.trace.col(place++) = link.X_WL.translation();
    }
  }
  result.finite = !machine->non_finite().has_value();
  return result;
}

/// Runs an extrapolation of that order, from runs of step_s and its parts.
Run run_extrapolated(const MachineCase& of, int order, double step_s) {
  Run sum;
  sum.trace = extrapolated(order, [&](int parts) {
    Run part = run(of, step_s / parts);
    sum.links = part.links;
    sum.cpu_s += part.cpu_s;
    sum.finite = sum.finite && part.finite;
    return part.trace;
  });
  return sum;
}

double median_cpu_s(std::vector<double> spans_s) {
  std::ranges::sort(spans_s);
  return spans_s[spans_s.size() / 2];
}

MachineDistance distance(const Run& one, const Run& other) {
  MachineDistance result;
  const auto greater = [](double a, double b) { return a > b || std::isnan(a) ? a : b; };
  for (Eigen::Index i = 0; i < one.trace.cols(); ++i) {
    const double apart = (one.trace.col(i) - other.trace.col(i)).norm();
    result.greatest_m = greater(result.greatest_m, apart);
    if (i + static_cast<Eigen::Index>(one.links) >= one.trace.cols()) {
      result.final_m = greater(result.final_m, apart);
    }
  }
  if (!one.finite || !other.finite) {
    result = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  return result;
}

void check_step(double step_s) {
  const double count = to_seconds(kGrid) / step_s;
  if (!(step_s > 0.0) || std::abs(count - std::round(count)) > 1e-6 || count < 0.5) {
    throw std::invalid_argument(
        fmt::format("step: found {} s, allowed: divides {} s", step_s, to_seconds(kGrid)));
  }
}

void check_span(const MachineCase& machine_case) {
  if (machine_case.span <= Duration{0} || machine_case.span % kGrid != Duration{0}) {
    throw std::invalid_argument(fmt::format("span: found {} s, allowed: a multiple of {} s",
                                            to_seconds(machine_case.span), to_seconds(kGrid)));
  }
}

MachinePrecisionRow measure_row(const MachineCase& of, const StepMethod& method, double step_s,
                                const Run& reference, int most_repetitions) {
  constexpr double kStepsWanted = 30000.0;
  MachinePrecisionRow row;
  row.method = method.name;
  row.step_s = step_s;
  const double steps =
      static_cast<double>(of.span / kGrid) * std::round(to_seconds(kGrid) / step_s);
  const int repetitions =
      std::clamp(static_cast<int>(kStepsWanted / steps), 1, std::max(1, most_repetitions));
  try {
    std::vector<double> spans_s;
    Run found;
    for (int i = 0; i < repetitions; ++i) {
      found = run_extrapolated(of, method.order, step_s);
      spans_s.push_back(found.cpu_s);
    }
    row.microseconds_per_step = 1e6 * median_cpu_s(spans_s) / steps;
    const MachineDistance error = distance(found, reference);
    row.diverged = !found.finite || !(error.greatest_m < kLost_m);
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    row.final_error_m = row.diverged ? kInfinite : error.final_m;
    row.greatest_error_m = row.diverged ? kInfinite : error.greatest_m;
  } catch (const std::invalid_argument& refusal) {
    row.refusal = refusal.what();
  }
  return row;
}

}  // namespace

MachinePrecision measure_machine_precision(const MachineCase& machine_case,
                                           const MachinePrecisionSettings& settings) {
  check_span(machine_case);
  const double reference_step_s = settings.reference_step_s;
  check_step(reference_step_s);
  check_step(2.0 * reference_step_s);
  for (const double step_s : settings.steps_s) {
    check_step(step_s);
    if (step_s < 4.999 * reference_step_s) {
      throw std::invalid_argument(
          fmt::format("reference_step_s: found {}, allowed: at most a fifth of the step {}",
                      reference_step_s, step_s));
    }
  }
  const int order = kMachineMethods.back().order;
  const Run reference = run_extrapolated(machine_case, order, reference_step_s);

  MachinePrecision result;
  result.reference_gap_m =
      distance(run_extrapolated(machine_case, order, 2.0 * reference_step_s), reference).greatest_m;
  for (const StepMethod& method : kMachineMethods) {
    for (const double step_s : settings.steps_s) {
      result.rows.push_back(
          measure_row(machine_case, method, step_s, reference, settings.most_repetitions));
    }
  }
  return result;
}

std::optional<double> measured_order(const MachinePrecision& precision, const std::string& method) {
  constexpr double kCoarsest_s = 2e-3;
  double count = 0.0;
  double x_sum = 0.0;
  double y_sum = 0.0;
  double xx_sum = 0.0;
  double xy_sum = 0.0;
  for (const MachinePrecisionRow& row : precision.rows) {
    if (row.method != method || !row.refusal.empty() || row.diverged ||
        row.step_s > 1.001 * kCoarsest_s ||
        !(row.greatest_error_m > 3.0 * precision.reference_gap_m)) {
      continue;
    }
    const double x = std::log(row.step_s);
    const double y = std::log(row.greatest_error_m);
    count += 1.0;
    x_sum += x;
    y_sum += y;
    xx_sum += x * x;
    xy_sum += x * y;
  }
  if (count < 3.0) {
    return std::nullopt;
  }
  return (count * xy_sum - x_sum * y_sum) / (count * xx_sum - x_sum * x_sum);
}

MachineDistance machine_distance(const MachineCase& one, const MachineCase& other, double step_s) {
  check_span(one);
  check_step(step_s);
  MachineCase follower = other;
  follower.drive = one.drive;
  const Run a = run(one, step_s);
  const Run b = run(follower, step_s);
  if (a.trace.size() != b.trace.size() || a.links != b.links) {
    throw std::invalid_argument(
        fmt::format("machines: found {} and {} with different links or spans, allowed: the same",
                    one.machine, other.machine));
  }
  return distance(a, b);
}

double machine_step_us(const MachineCase& machine_case) {
  check_span(machine_case);
  constexpr Duration kStep = std::chrono::milliseconds(1);
  std::vector<double> spans_s;
  for (int i = 0; i < 5; ++i) {
    spans_s.push_back(run(machine_case, 1e-3, kStep).cpu_s);
  }
  return 1e6 * median_cpu_s(spans_s) / static_cast<double>(machine_case.span / kStep);
}

}  // namespace rigwire::bench
