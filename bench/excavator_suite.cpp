#include <fmt/format.h>

#include "bench/excavator_bench.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {
namespace {

Table precision_table(std::ostream& text) {
  return {text,
          {{"method", "<24"},
           {"stiffness", ">9"},
           {"step ms", ">8"},
           {"at 4 s m", ">12"},
           {"greatest m", ">12"},
           {"us/step", ">8"},
           {"x real", ">9"}}};
}

/// A diverged run has no error.
Cell error_cell(const char* key, const WorkPrecisionRow& row, double error_m) {
  return row.diverged ? cell(key, nullptr, "diverged") : number(key, error_m, "{:.2e}");
}

std::vector<Cell> cells(const WorkPrecisionRow& row) {
  const double realtime = 1e6 * row.step_s / row.microseconds_per_step;
  return {word("method", row.method.name),
          number("stiffness_factor", row.stiffness_factor, "{:g}"),
          number("step_s", row.step_s, "{:g}", 1e3),
          error_cell("final_error_m", row, row.final_error_m),
          error_cell("greatest_error_m", row, row.greatest_error_m),
          number("us_per_step", row.microseconds_per_step, "{:.2f}"),
          shown(fmt::format("{:.0f}x", realtime)),
          stored("diverged", row.diverged)};
}

}  // namespace

nlohmann::json bench_excavator(std::ostream& text) {
  nlohmann::json json;
  WorkPrecisionSettings settings;
  settings.repetitions = 3;
  const Table table = precision_table(text);
  table.head();
  for (const WorkPrecisionRow& row : measure_work_precision(settings)) {
    json["work_precision"].push_back(table.row(cells(row)));
  }
  const double simbody_rad = reference_pose_error_rad();
  json["reference_error_rad"] = simbody_rad;
  text << fmt::format("the reference itself ends {:.1e} rad from Simbody's pose\n\n", simbody_rad);

  text << "stiffest drives allowed at 1 ms, times the oil's stiffness:\n";
  table.head();
  const StiffestDrive drive = measure_stiffest_drive();
  json["stiffest"] = {{"allowed_factor", drive.factor},
                      {"row", table.row(cells(drive.row))},
                      {"machine_stable", drive.machine_stable},
                      {"refused_factor", drive.refused_factor},
                      {"refusal", drive.refusal}};
  text << fmt::format("  the whole machine, moved for 4 s: {}\n  refused at {:.4g}: {}\n",
                      drive.machine_stable ? "stable" : "UNSTABLE", drive.refused_factor,
                      drive.refusal);

  const ExcavatorStepCost cost = measure_excavator_step();
  json["step_us"] = {{"median", cost.median_us}, {"p999", cost.p999_us}};
  text << fmt::format("\nwhole machine, one step of 1 ms: median {:.2f} us, p99.9 {:.2f} us\n",
                      cost.median_us, cost.p999_us);

  struct Variant {
    const char* name;
    sim::ExcavatorLevel level;
    sim::ExcavatorCarrier carrier;
  };
  using Level = sim::ExcavatorLevel;
  using Carrier = sim::ExcavatorCarrier;
  for (const Variant& variant :
       {Variant{"kinematic", Level::kinematic, Carrier::fixed},
        Variant{"quasi_static", Level::quasi_static, Carrier::fixed},
        Variant{"dynamic", Level::dynamic, Carrier::fixed},
        Variant{"chambers", Level::chambers, Carrier::fixed},
        Variant{"dynamic, moving carrier", Level::dynamic, Carrier::moving},
        Variant{"chambers, moving carrier", Level::chambers, Carrier::moving}}) {
    const ExcavatorStepCost each = measure_excavator_step(10000, variant.level, variant.carrier);
    json["levels"].push_back(
        {{"name", variant.name}, {"median_us", each.median_us}, {"p999_us", each.p999_us}});
    text << fmt::format("  {:<26} median {:.2f} us, p99.9 {:.2f} us\n", variant.name,
                        each.median_us, each.p999_us);
  }
  return json;
}

}  // namespace rigwire::bench
