#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bench/contact_cases.h"
#include "bench/contact_traces.h"
#include "bench/drawbar.h"
#include "bench/suites.h"
#include "bench/table.h"

namespace rigwire::bench {
namespace {

nlohmann::json cost_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << "a Unimog's step among trees, level full, 5 m/s, 1 ms; about: the way free, along: 0.1 m "
          "beside its tyres\n";
  const Table table(text, {{"trees", "<8"}, {"count", ">6"}, {"us/step", ">8"}, {"x none", ">7"}});
  table.head();
  double none_us = 0.0;
  for (const ContactCost& cost : measure_contact_cost()) {
    none_us = none_us == 0.0 ? cost.us_per_step : none_us;
    json.push_back(table.row({word("where", cost.where), count("trees", cost.trees),
                              number("us_per_step", cost.us_per_step, "{:.2f}"),
                              number("over_none", cost.us_per_step / none_us, "{:.2f}")}));
  }
  return json;
}

nlohmann::json step_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << "\nover the step: energy that contacts gave at most, deepest overlap, dent, tyre pressed "
          "in, greatest force; "
          "figure against its closed form\n";
  const Table table(text, {{"case", "<24"},
                           {"step ms", ">8"},
                           {"came kJ", ">8"},
                           {"gave J", ">9"},
                           {"deepest mm", ">11"},
                           {"dent mm", ">8"},
                           {"tyre mm", ">8"},
                           {"force kN", ">9"},
                           {"found", ">9"},
                           {"closed", ">9"},
                           {"figure", "<16"}});
  table.head();
  for (const ContactCase& each : contact_cases()) {
    for (const double step_s : {1e-4, 5e-4, 1e-3, 2e-3, 5e-3}) {
      const ContactOutcome outcome = each.run(step_s);
      const bool closed = !each.figure.empty();
      json.push_back(table.row(
          {word("case", each.name), number("step_s", step_s, "{:g}", 1e3),
           number("came_with_j", outcome.came_with_j, "{:.1f}", 1e-3),
           number("gave_j", outcome.gave_j, "{:.3g}"),
           number("deepest_m", outcome.deepest_m, "{:.2f}", 1e3),
           number("dent_m", outcome.dent_m, "{:.0f}", 1e3),
           number("pressed_m", outcome.pressed_m, "{:.0f}", 1e3),
           number("greatest_n", outcome.greatest_n, "{:.0f}", 1e-3),
           closed ? number("found", outcome.found, "{:.4f}") : cell("found", nullptr, "-"),
           closed ? number("closed_form", each.closed_form, "{:.4f}")
                  : cell("closed_form", nullptr, "-"),
           word("figure", each.figure), stored("finite", outcome.finite)}));
    }
  }
  return json;
}

nlohmann::json stack_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << "\nthree crates of 1 t on each other, 1 ms\n";
  const Table table(
      text,
      {{"stack", "<12"}, {"s", ">6"}, {"drift um", ">9"}, {"gave J", ">9"}, {"us/step", ">8"}});
  table.head();
  for (const bool awake : {false, true}) {
    const StackRest rest = rest_stack(awake);
    json.push_back(table.row(
        {word("stack", awake ? "kept awake" : "at rest"), number("span_s", rest.span_s, "{:.0f}"),
         number("drift_m", rest.drift_m, "{:.3g}", 1e6), number("gave_j", rest.gave_j, "{:.3g}"),
         number("us_per_step", rest.us_per_step, "{:.2f}")}));
  }
  return json;
}

nlohmann::json sweep_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text
      << "\nshipped scenes, 1 ms: the worst of many runs; thrown: faster by a tenth than it came\n";
  const Table table(text, {{"what", "<42"},
                           {"runs", ">5"},
                           {"touched", ">8"},
                           {"thrown", ">7"},
                           {"gave J", ">9"},
                           {"deepest mm", ">11"},
                           {"dent mm", ">8"},
                           {"tyre mm", ">8"}});
  table.head();
  const auto row = [&](const ContactSweep& sweep) {
    json.push_back(table.row({word("name", sweep.name), count("runs", sweep.runs),
                              count("touched", sweep.touched), count("thrown", sweep.thrown),
                              number("gave_j", sweep.worst.gave_j, "{:.3g}"),
                              number("deepest_m", sweep.worst.deepest_m, "{:.2f}", 1e3),
                              number("dent_m", sweep.worst.dent_m, "{:.0f}", 1e3),
                              number("pressed_m", sweep.worst.pressed_m, "{:.0f}", 1e3),
                              stored("finite", sweep.worst.finite)}));
  };
  row(sweep_pit(10));
  for (const sim::VehicleLevel level :
       {sim::VehicleLevel::kinematic, sim::VehicleLevel::planar, sim::VehicleLevel::full}) {
    row(sweep_forest(level));
  }
  return json;
}

nlohmann::json drawbar_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << "\npull of one 395/85 R20 at 22 kN over its slip, shares of the load: the tyre's own; "
          "Bekker "
          "and Wong in closed form; Brixius' fit to field tests\n";
  const Table table(text, {{"soil", "<24"},
                           {"bar", ">5"},
                           {"Bn", ">6"},
                           {"slip", ">6"},
                           {"pull", ">7"},
                           {"closed", ">7"},
                           {"error", ">7"},
                           {"Brixius", ">8"},
                           {"error", ">7"},
                           {"resistance", ">11"},
                           {"closed", ">7"},
                           {"Brixius", ">8"},
                           {"rut mm", ">7"}});
  table.head();
  for (const DrawbarCase& each : drawbar_cases()) {
    const double mobility = mobility_number(each);
    for (const double slip : {0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5}) {
      const Drawbar found = measured_drawbar(each, slip);
      const Drawbar closed = closed_drawbar(each, slip);
      const Drawbar published = published_drawbar(mobility, slip);
      json.push_back(table.row(
          {word("soil", each.soil.name), number("pressure_pa", each.pressure_pa, "{:.1f}", 1e-5),
           number("mobility", mobility, "{:.1f}"), number("slip", slip, "{:.2f}"),
           number("pull", found.pull(), "{:.3f}"), number("closed", closed.pull(), "{:.3f}"),
           number("", found.pull() - closed.pull(), "{:+.3f}"),
           number("published", published.pull(), "{:.3f}"),
           number("", found.pull() - published.pull(), "{:+.3f}"),
           number("resistance", found.resistance, "{:.3f}"),
           number("closed_resistance", closed.resistance, "{:.3f}"),
           number("published_resistance", published.resistance, "{:.3f}"),
           number("rut_m", found.sinkage_m, "{:.0f}", 1e3)}));
    }
  }
  return json;
}

nlohmann::json points(const std::vector<Outline>& outlines) {
  nlohmann::json json = nlohmann::json::array();
  for (const Outline& outline : outlines) {
    nlohmann::json corners = nlohmann::json::array();
    for (const Eigen::Vector2d& corner : outline) {
      corners.push_back({number_or_null(corner.x()), number_or_null(corner.y())});
    }
    json.push_back(std::move(corners));
  }
  return json;
}

nlohmann::json trace_table(std::ostream& text) {
  nlohmann::json json = nlohmann::json::array();
  text << "\nfrom the side, instant by instant in the JSON file, 1 ms\n";
  const Table table(
      text, {{"meeting", "<42"}, {"force kN", ">9"}, {"deepest mm", ">11"}, {"dent mm", ">8"}});
  table.head();
  for (const ContactTrace& trace : {drive_into_trunk(), lower_onto_rock()}) {
    ContactTrace::Instant most;
    nlohmann::json instants = nlohmann::json::array();
    for (const ContactTrace::Instant& one : trace.instants) {
      most.force_n = std::max(most.force_n, one.force_n);
      most.deepest_m = std::max(most.deepest_m, one.deepest_m);
      most.dent_m = std::max(most.dent_m, one.dent_m);
      instants.push_back({{"time_s", one.time_s},
                          {"x_m", number_or_null(one.x_m)},
                          {"z_m", number_or_null(one.z_m)},
                          {"force_n", number_or_null(one.force_n)},
                          {"deepest_m", number_or_null(one.deepest_m)},
                          {"dent_m", number_or_null(one.dent_m)}});
    }
    json.push_back(table.row(
        {word("name", trace.name), number("greatest_n", most.force_n, "{:.0f}", 1e-3),
         number("deepest_m", most.deepest_m, "{:.2f}", 1e3),
         number("dent_m", most.dent_m, "{:.0f}", 1e3), stored("instants", std::move(instants)),
         stored("obstacle", points(trace.obstacle)), stored("at_touch", points(trace.at_touch)),
         stored("at_end", points(trace.at_end))}));
  }
  return json;
}

}  // namespace

nlohmann::json bench_contact(std::ostream& text) {
  nlohmann::json json;
  json["cost"] = cost_table(text);
  json["over_step"] = step_table(text);
  json["stack"] = stack_table(text);
  json["scenes"] = sweep_table(text);
  json["drawbar"] = drawbar_table(text);
  json["traces"] = trace_table(text);
  return json;
}

}  // namespace rigwire::bench
