#include <fmt/format.h>

#include "hil/bench/excavator_bench.h"
#include "hil/bench/suites.h"

namespace rigwire::hil {
namespace {

nlohmann::json row_json(const WorkPrecisionRow& row) {
  // A diverged run has no error: null.
  const auto error = [&](double value) {
    return row.diverged ? nlohmann::json() : nlohmann::json(value);
  };
  return {{"scheme", name_of(row.scheme)},
          {"stiffness_factor", row.stiffness_factor},
          {"step_s", row.step_s},
          {"diverged", row.diverged},
          {"final_error_m", error(row.final_error_m)},
          {"greatest_error_m", error(row.greatest_error_m)},
          {"us_per_step", row.microseconds_per_step}};
}

std::string error_text(const WorkPrecisionRow& row, double error_m) {
  return row.diverged ? "diverged" : fmt::format("{:.2e}", error_m);
}

void row_text(std::ostream& text, const WorkPrecisionRow& row) {
  const double realtime = 1e6 * row.step_s / row.microseconds_per_step;
  text << fmt::format("{:<24} {:>9g} {:>8g} {:>12} {:>12} {:>8.2f} {:>8.0f}x\n",
                      name_of(row.scheme), row.stiffness_factor, 1e3 * row.step_s,
                      error_text(row, row.final_error_m), error_text(row, row.greatest_error_m),
                      row.microseconds_per_step, realtime);
}

void header(std::ostream& text) {
  text << fmt::format("{:<24} {:>9} {:>8} {:>12} {:>12} {:>8} {:>9}\n", "scheme", "stiffness",
                      "step ms", "at 4 s m", "greatest m", "us/step", "x real");
}

}  // namespace

nlohmann::json bench_excavator(std::ostream& text) {
  nlohmann::json json;
  WorkPrecisionSettings settings;
  settings.repetitions = 3;
  header(text);
  for (const WorkPrecisionRow& row : measure_work_precision(settings)) {
    row_text(text, row);
    json["work_precision"].push_back(row_json(row));
  }
  const double simbody_rad = reference_pose_error_rad();
  json["reference_error_rad"] = simbody_rad;
  text << fmt::format("the reference itself ends {:.1e} rad from Simbody's pose\n\n", simbody_rad);

  text << "stiffest drives allowed at 1 ms, times the oil's stiffness:\n";
  header(text);
  for (const StiffestDrive& drive : measure_stiffest_drives()) {
    nlohmann::json entry{{"scheme", name_of(drive.scheme)},
                         {"allowed_factor", drive.factor},
                         {"refused_factor", drive.refused_factor},
                         {"refusal", drive.refusal}};
    if (drive.factor > 0.0) {
      row_text(text, drive.row);
      text << fmt::format("  the whole machine, moved for 4 s: {}\n",
                          drive.machine_stable ? "stable" : "UNSTABLE");
      entry["row"] = row_json(drive.row);
      entry["machine_stable"] = drive.machine_stable;
    } else {
      text << fmt::format("{:<24} none\n", name_of(drive.scheme));
    }
    text << fmt::format("  refused at {:.4g}: {}\n", drive.refused_factor, drive.refusal);
    json["stiffest"].push_back(entry);
  }

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

}  // namespace rigwire::hil
