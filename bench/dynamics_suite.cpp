#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/machine_cases.h"
#include "bench/machine_precision.h"
#include "bench/machine_precision_json.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {
namespace {

constexpr double kStep_s = 1e-3;

std::string error_text(const MachinePrecisionRow& row) {
  if (!row.refusal.empty()) {
    return "refused";
  }
  return row.diverged ? "diverged" : fmt::format("{:.1e}", row.greatest_error_m);
}

/// Writes one line per method: maximum error at each step, cost at 1 ms.
void precision_text(std::ostream& text, const MachineCase& of, const MachinePrecision& found) {
  for (const StepMethod& method : kMachineMethods) {
    text << fmt::format("{:<18} {:<12} {:<8} {:>6g} {:<23}", of.machine, of.level, of.scene,
                        of.stiffness_factor, method.name);
    double us = std::nan("");
    for (const MachinePrecisionRow& row : found.rows) {
      if (row.method == method.name) {
        text << fmt::format(" {:>8}", error_text(row));
        if (row.refusal.empty() && row.step_s <= 1.001 * kStep_s) {
          us = row.microseconds_per_step;
        }
      }
    }
    const auto order = measured_order(found, method.name);
    text << fmt::format(" {:>5} {:>6.2f} {:>8.1e}\n", order ? fmt::format("{:.2f}", *order) : "-",
                        us, found.reference_gap_m);
  }
}

nlohmann::json precision_table(std::ostream& text, const std::vector<MachineCase>& cases) {
  const MachinePrecisionSettings settings;
  nlohmann::json json = nlohmann::json::array();
  text << "greatest error in m at each step in ms; order up to 2 ms; us per step at 1 ms (or the "
          "greatest\nallowed below); gap: reference (extrapolated, 0.02 ms) against twice its "
          "step\n";
  text << fmt::format("{:<18} {:<12} {:<8} {:>6} {:<23}", "machine", "level", "scene", "stiff x",
                      "method");
  for (const double step_s : settings.steps_s) {
    text << fmt::format(" {:>8g}", 1e3 * step_s);
  }
  text << fmt::format(" {:>5} {:>6} {:>8}\n", "order", "us", "gap");
  for (const MachineCase& machine_case : cases) {
    const MachinePrecision found = measure_machine_precision(machine_case, settings);
    precision_text(text, machine_case, found);
    json.push_back(precision_json(machine_case, found));
  }
  return json;
}

/// Every level against the fullest of the same machine in the same scene.
nlohmann::json level_table(std::ostream& text, const std::vector<MachineCase>& cases) {
  nlohmann::json json = nlohmann::json::array();
  text << "\nlevels of a machine at 1 ms, distance from its fullest (model error)\n";
  const Table table(text, {{"machine", "<18"},
                           {"level", "<12"},
                           {"scene", "<8"},
                           {"at end m", ">10"},
                           {"greatest", ">10"},
                           {"us/step", ">8"}});
  table.head();
  for (const MachineCase& one : cases) {
    const auto same = [&](const MachineCase& other) {
      return other.machine == one.machine && other.scene == one.scene &&
             other.stiffness_factor == 1.0;
    };
    if (!same(one)) {
      continue;
    }
    const auto fullest = std::find_if(cases.rbegin(), cases.rend(), same);
    const MachineDistance apart = machine_distance(*fullest, one, kStep_s);
    json.push_back(table.row({word("machine", one.machine), word("level", one.level),
                              word("scene", one.scene), number("final_m", apart.final_m, "{:.2e}"),
                              number("greatest_m", apart.greatest_m, "{:.2e}"),
                              number("us_per_step", machine_step_us(one), "{:.2f}"),
                              stored("against", fullest->level)}));
  }
  return json;
}

nlohmann::json variation_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << "\none estimated parameter 20 % greater, 1 ms (parameter error)\n";
  const Table table(text, {{"machine", "<18"},
                           {"level", "<12"},
                           {"scene", "<8"},
                           {"parameter", "<32"},
                           {"at end m", ">10"},
                           {"greatest", ">10"}});
  table.head();
  for (const MachineVariation& each : machine_variations()) {
    const MachineDistance apart = machine_distance(each.nominal, each.varied, kStep_s);
    const MachineCase& of = each.nominal;
    json.push_back(
        table.row({word("machine", of.machine), word("level", of.level), word("scene", of.scene),
                   word("parameter", each.quantity), number("final_m", apart.final_m, "{:.2e}"),
                   number("greatest_m", apart.greatest_m, "{:.2e}")}));
  }
  return json;
}

}  // namespace

nlohmann::json bench_dynamics(std::ostream& text) {
  const std::vector<MachineCase> cases = machine_cases();
  nlohmann::json json;
  json["precision"] = precision_table(text, cases);
  json["levels"] = level_table(text, cases);
  json["variations"] = variation_table(text);
  return json;
}

}  // namespace rigwire::bench
