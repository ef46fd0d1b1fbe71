#include <fmt/format.h>

#include "hil/bench/machine_cases.h"
#include "hil/bench/machine_precision.h"
#include "hil/bench/suites.h"

namespace rigwire::hil {
namespace {

std::string error_text(const MachinePrecisionRow& row, double error_m) {
  return row.diverged ? "diverged" : fmt::format("{:.2e}", error_m);
}

nlohmann::json row_json(const MachinePrecisionRow& row) {
  if (!row.refusal.empty()) {
    return {{"step_s", row.step_s}, {"refusal", row.refusal}};
  }
  const auto error = [&](double value) {
    return row.diverged ? nlohmann::json() : nlohmann::json(value);
  };
  return {{"step_s", row.step_s},
          {"diverged", row.diverged},
          {"final_error_m", error(row.final_error_m)},
          {"greatest_error_m", error(row.greatest_error_m)},
          {"us_per_step", row.microseconds_per_step}};
}

void row_text(std::ostream& text, const MachineCase& of, const MachinePrecisionRow& row) {
  text << fmt::format("{:<22} {:<14} {:<24} {:>7g} {:>6g} ", of.machine, of.level, of.method,
                      of.stiffness_factor, 1e3 * row.step_s);
  if (!row.refusal.empty()) {
    text << " refused\n";
    return;
  }
  text << fmt::format("{:>10} {:>10} {:>8.2f} {:>8.0f}x\n", error_text(row, row.final_error_m),
                      error_text(row, row.greatest_error_m), row.microseconds_per_step,
                      1e6 * row.step_s / row.microseconds_per_step);
}

}  // namespace

nlohmann::json bench_dynamics(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << fmt::format("{:<22} {:<14} {:<24} {:>7} {:>6} {:>10} {:>10} {:>8} {:>9}\n", "machine",
                      "level", "method", "stiff x", "ms", "at end m", "greatest", "us/step",
                      "x real");
  for (const MachineCase& machine_case : machine_cases()) {
    nlohmann::json entry{{"machine", machine_case.machine},
                         {"level", machine_case.level},
                         {"method", machine_case.method},
                         {"stiffness_factor", machine_case.stiffness_factor},
                         {"rows", nlohmann::json::array()}};
    for (const MachinePrecisionRow& row : measure_machine_precision(machine_case)) {
      row_text(text, machine_case, row);
      entry["rows"].push_back(row_json(row));
    }
    json.push_back(entry);
  }
  return json;
}

}  // namespace rigwire::hil
