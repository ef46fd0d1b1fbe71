#include "hil/bench/machine_precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "hil/cpu_time.h"

namespace rigwire::hil {
namespace {

constexpr Duration kGrid = std::chrono::milliseconds(20);
constexpr double kLost_m = 10.0;

/// Origins of all links, grid point after grid point.
using Trace = std::vector<Eigen::Vector3d>;

struct Run {
  Trace trace;
  double cpu_s = 0.0;
  bool finite = true;
};

Run run(const MachineCase& machine_case, double step_s) {
  Run result;
  const auto machine = machine_case.make(step_s);
  const auto points = static_cast<std::size_t>(machine_case.span / kGrid);
  result.trace.reserve(points * machine->links().size());
  for (std::size_t i = 0; i < points; ++i) {
    machine_case.drive(*machine, kStart + static_cast<int>(i) * kGrid);
    const double begin_s = thread_cpu_seconds();
    machine->step(kGrid);
    result.cpu_s += thread_cpu_seconds() - begin_s;
    for (const sim::LinkMotion& link : machine->links()) {
      result.trace.push_back(link.X_WL.translation());
    }
  }
  result.finite = !machine->non_finite().has_value();
  return result;
}

MachinePrecisionRow compare(const Run& found, const Run& reference, std::size_t links) {
  MachinePrecisionRow row;
  row.diverged = !found.finite;
  for (std::size_t i = 0; i < found.trace.size(); ++i) {
    const double error = (found.trace[i] - reference.trace[i]).norm();
    row.diverged = row.diverged || !(error < kLost_m);
    row.greatest_error_m = std::max(row.greatest_error_m, error);
    if (i + links >= found.trace.size()) {
      row.final_error_m = std::max(row.final_error_m, error);
    }
  }
  if (row.diverged) {
    row.greatest_error_m = std::numeric_limits<double>::infinity();
    row.final_error_m = row.greatest_error_m;
  }
  return row;
}

void check_step(double step_s) {
  const double count = to_seconds(kGrid) / step_s;
  if (!(step_s > 0.0) || std::abs(count - std::round(count)) > 1e-6 || count < 0.5) {
    throw std::invalid_argument(fmt::format("machine precision: step {} s does not divide {} s",
                                            step_s, to_seconds(kGrid)));
  }
}

}  // namespace

std::vector<MachinePrecisionRow> measure_machine_precision(
    const MachineCase& machine_case, const MachinePrecisionSettings& settings) {
  check_step(settings.reference_step_s);
  for (const double step_s : settings.steps_s) {
    check_step(step_s);
  }
  const Run reference = run(machine_case, settings.reference_step_s);
  const std::size_t links = machine_case.make(settings.reference_step_s)->links().size();
  const double grid_points = to_seconds(machine_case.span) / to_seconds(kGrid);

  std::vector<MachinePrecisionRow> rows;
  for (const double step_s : settings.steps_s) {
    try {
      std::vector<double> spans_s;
      Run found;
      for (int i = 0; i < settings.repetitions; ++i) {
        found = run(machine_case, step_s);
        spans_s.push_back(found.cpu_s);
      }
      std::ranges::sort(spans_s);
      rows.push_back(compare(found, reference, links));
      const double steps = grid_points * std::round(to_seconds(kGrid) / step_s);
      rows.back().microseconds_per_step = 1e6 * spans_s[spans_s.size() / 2] / steps;
    } catch (const std::invalid_argument& refusal) {
      rows.emplace_back();
      rows.back().refusal = refusal.what();
    }
    rows.back().step_s = step_s;
  }
  return rows;
}

}  // namespace rigwire::hil
