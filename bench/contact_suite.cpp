#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/contact_cases.h"
#include "bench/contact_traces.h"
#include "bench/cost.h"
#include "bench/drawbar.h"
#include "bench/suites.h"
#include "bench/table.h"
#include "bench/track_cases.h"

namespace rigwire::bench {
namespace {

/// One table: `cells` of each of `rows`, which may be what is still to be run.
template <class Rows, class Cells>
nlohmann::json tabulate(std::ostream& text, std::string_view title, std::vector<Column> columns,
                        const Rows& rows, Cells&& cells) {
  text << title << '\n';
  const Table table(text, std::move(columns));
  table.head();
  nlohmann::json json = nlohmann::json::array();
  for (const auto& row : rows) {
    json.push_back(table.row(cells(row)));
  }
  return json;
}

/// Each of the first with each of the second.
template <class First, class Second>
std::vector<std::pair<typename First::value_type, typename Second::value_type>> pairs(
    const First& first, const Second& second) {
  std::vector<std::pair<typename First::value_type, typename Second::value_type>> all;
  for (const auto& one : first) {
    for (const auto& other : second) {
      all.emplace_back(one, other);
    }
  }
  return all;
}

/// A column beside another that it is compared with.
Cell error(double found, double other, std::string_view format) {
  return number("", found - other, format);
}

nlohmann::json cost_table(std::ostream& text) {
  double none_us = 0.0;
  return tabulate(
      text,
      "a Unimog's step among trees, level full, 5 m/s, 1 ms; about: the way free, along: 0.1 m "
      "beside its tyres",
      {{"trees", "<8"}, {"count", ">6"}, {"us/step", ">8"}, {"x none", ">7"}},
      measure_contact_cost(), [&](const ContactCost& cost) -> std::vector<Cell> {
        none_us = none_us == 0.0 ? cost.us_per_step : none_us;
        return {word("where", cost.where), count("trees", cost.trees),
                number("us_per_step", cost.us_per_step, "{:.2f}"),
                number("over_none", cost.us_per_step / none_us, "{:.2f}")};
      });
}

nlohmann::json step_table(std::ostream& text) {
  return tabulate(
      text,
      "\nover the step: energy that contacts gave at most, deepest overlap, dent, tyre pressed in, "
      "greatest force; figure against its closed form",
      {{"case", "<24"},
       {"step ms", ">8"},
       {"came kJ", ">8"},
       {"gave J", ">9"},
       {"deepest mm", ">11"},
       {"dent mm", ">8"},
       {"tyre mm", ">8"},
       {"force kN", ">9"},
       {"found", ">9"},
       {"closed", ">9"},
       {"figure", "<16"}},
      pairs(contact_cases(), std::array{1e-4, 5e-4, 1e-3, 2e-3, 5e-3}),
      [](const auto& run) -> std::vector<Cell> {
        const auto& [each, step_s] = run;
        const ContactOutcome outcome = each.run(step_s);
        const bool closed = !each.figure.empty();
        return {word("case", each.name),
                number("step_s", step_s, "{:g}", 1e3),
                number("came_with_j", outcome.came_with_j, "{:.1f}", 1e-3),
                number("gave_j", outcome.gave_j, "{:.3g}"),
                number("deepest_m", outcome.deepest_m, "{:.2f}", 1e3),
                number("dent_m", outcome.dent_m, "{:.0f}", 1e3),
                number("pressed_m", outcome.pressed_m, "{:.0f}", 1e3),
                number("greatest_n", outcome.greatest_n, "{:.0f}", 1e-3),
                closed ? number("found", outcome.found, "{:.4f}") : cell("found", nullptr, "-"),
                closed ? number("closed_form", each.closed_form, "{:.4f}")
                       : cell("closed_form", nullptr, "-"),
                word("figure", each.figure),
                stored("finite", outcome.finite)};
      });
}

nlohmann::json stack_table(std::ostream& text) {
  return tabulate(
      text, "\nthree crates of 1 t on each other, 1 ms",
      {{"stack", "<12"}, {"s", ">6"}, {"drift um", ">9"}, {"gave J", ">9"}, {"us/step", ">8"}},
      std::array{false, true}, [](bool awake) -> std::vector<Cell> {
        const StackRest rest = rest_stack(awake);
        return {word("stack", awake ? "kept awake" : "at rest"),
                number("span_s", rest.span_s, "{:.0f}"),
                number("drift_m", rest.drift_m, "{:.3g}", 1e6),
                number("gave_j", rest.gave_j, "{:.3g}"),
                number("us_per_step", rest.us_per_step, "{:.2f}")};
      });
}

nlohmann::json sweep_table(std::ostream& text) {
  using Sweep = std::function<ContactSweep()>;
  using Level = sim::VehicleLevel;
  return tabulate(
      text,
      "\nshipped scenes, 1 ms: the worst of many runs; thrown: faster by a tenth than it came",
      {{"what", "<42"},
       {"runs", ">5"},
       {"touched", ">8"},
       {"thrown", ">7"},
       {"gave J", ">9"},
       {"deepest mm", ">11"},
       {"dent mm", ">8"},
       {"tyre mm", ">8"}},
      std::array{Sweep([] { return sweep_pit(10); }),
                 Sweep([] { return sweep_forest(Level::kinematic); }),
                 Sweep([] { return sweep_forest(Level::planar); }),
                 Sweep([] { return sweep_forest(Level::full); })},
      [](const Sweep& run) -> std::vector<Cell> {
        const ContactSweep sweep = run();
        return {word("name", sweep.name),
                count("runs", sweep.runs),
                count("touched", sweep.touched),
                count("thrown", sweep.thrown),
                number("gave_j", sweep.worst.gave_j, "{:.3g}"),
                number("deepest_m", sweep.worst.deepest_m, "{:.2f}", 1e3),
                number("dent_m", sweep.worst.dent_m, "{:.0f}", 1e3),
                number("pressed_m", sweep.worst.pressed_m, "{:.0f}", 1e3),
                stored("finite", sweep.worst.finite)};
      });
}

nlohmann::json track_table(std::ostream& text) {
  return tabulate(
      text, "\nthe excavator on tracks, its weight over their middle, against closed forms",
      {{"case", "<22"},
       {"step ms", ">8"},
       {"found", ">11"},
       {"closed", ">11"},
       {"error", ">8"},
       {"figure", "<18"}},
      pairs(track_cases(), std::array{1e-3, 2e-3, 5e-3}), [](const auto& run) -> std::vector<Cell> {
        const auto& [each, step_s] = run;
        const double found = each.run(step_s);
        return {word("case", each.name),
                number("step_s", step_s, "{:g}", 1e3),
                number("found", found, "{:.5g}"),
                number("closed_form", each.closed_form, "{:.5g}"),
                number("", found / each.closed_form - 1.0, "{:+.2f}%", 100.0),
                word("figure", each.figure)};
      });
}

nlohmann::json track_cost_table(std::ostream& text) {
  const std::array<std::pair<const char*, ValveCommand>, 3> doing{
      {{"stands", {}},
       {"travels", tracks::travel(0.5, 0.5)},
       {"spins", tracks::travel(-0.5, 0.5)}}};
  return tabulate(
      text, "\nCPU time of its step of 1 ms with 7 stations to a track",
      {{"doing", "<12"}, {"us/step", ">8"}}, doing, [](const auto& row) -> std::vector<Cell> {
        const sim::Ground ground;
        sim::ExcavatorParameters p = tracks::balanced(1e-3);
        p.tracks.stations = sim::TrackParameters{}.stations;
        sim::Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
        machine.command(row.second);
        const double ns = nanoseconds_of([&](int) { machine.step(std::chrono::milliseconds(1)); });
        return {word("doing", row.first), number("us_per_step", 1e-3 * ns, "{:.2f}")};
      });
}

nlohmann::json drawbar_table(std::ostream& text) {
  return tabulate(
      text,
      "\npull of one 395/85 R20 at 22 kN over its slip, shares of the load: the tyre's own; Bekker "
      "and Wong in closed form; Brixius' fit to field tests",
      {{"soil", "<24"},
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
       {"rut mm", ">7"}},
      pairs(drawbar_cases(), std::array{0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5}),
      [](const auto& run) -> std::vector<Cell> {
        const auto& [each, slip] = run;
        const double mobility = mobility_number(each);
        const Drawbar found = measured_drawbar(each, slip);
        const Drawbar closed = closed_drawbar(each, slip);
        const Drawbar published = published_drawbar(mobility, slip);
        return {word("soil", each.soil.name),
                number("pressure_pa", each.pressure_pa, "{:.1f}", 1e-5),
                number("mobility", mobility, "{:.1f}"),
                number("slip", slip, "{:.2f}"),
                number("pull", found.pull(), "{:.3f}"),
                number("closed", closed.pull(), "{:.3f}"),
                error(found.pull(), closed.pull(), "{:+.3f}"),
                number("published", published.pull(), "{:.3f}"),
                error(found.pull(), published.pull(), "{:+.3f}"),
                number("resistance", found.resistance, "{:.3f}"),
                number("closed_resistance", closed.resistance, "{:.3f}"),
                number("published_resistance", published.resistance, "{:.3f}"),
                number("rut_m", found.sinkage_m, "{:.0f}", 1e3)};
      });
}

nlohmann::json test_bed_table(std::ostream& text) {
  std::vector<std::pair<MeasuredWheel, MeasuredWheel::Point>> rows;
  for (const MeasuredWheel& wheel : measured_wheels()) {
    for (const MeasuredWheel::Point& point : wheel.points) {
      rows.emplace_back(wheel, point);
    }
  }
  return tabulate(
      text,
      "\npull of a rigid wheel of 157 mm with 80 N in a test bed (Ding and others 2011), shares of "
      "the load, and its rut: the tyre's own beside what was measured",
      {{"wheel", "<18"},
       {"slip", ">6"},
       {"pull", ">7"},
       {"measured", ">9"},
       {"error", ">7"},
       {"rut mm", ">7"},
       {"measured", ">9"}},
      rows, [](const auto& row) -> std::vector<Cell> {
        const auto& [each, point] = row;
        const Drawbar found = measured_drawbar(each.wheel, point.slip);
        const double measured = point.pull_n / each.wheel.load_n;
        return {word("wheel", each.name),
                number("slip", point.slip, "{:.2f}"),
                number("pull", found.pull(), "{:.3f}"),
                number("measured", measured, "{:.3f}"),
                error(found.pull(), measured, "{:+.3f}"),
                number("rut_m", found.sinkage_m, "{:.1f}", 1e3),
                number("measured_rut_m", point.sinkage_m, "{:.1f}", 1e3)};
      });
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
  return tabulate(text, "\nfrom the side, instant by instant in the JSON file, 1 ms",
                  {{"meeting", "<42"},
                   {"force kN", ">9"},
                   {"deepest mm", ">11"},
                   {"dent mm", ">8"},
                   {"tyre mm", ">8"}},
                  std::array{&drive_into_trunk, &lower_onto_rock, &roll_at_fallen_trunk},
                  [](ContactTrace (*meet)()) -> std::vector<Cell> {
                    const ContactTrace trace = meet();
                    ContactTrace::Instant most;
                    nlohmann::json instants = nlohmann::json::array();
                    for (const ContactTrace::Instant& one : trace.instants) {
                      most.force_n = std::max(most.force_n, one.force_n);
                      most.deepest_m = std::max(most.deepest_m, one.deepest_m);
                      most.dent_m = std::max(most.dent_m, one.dent_m);
                      most.pressed_m = std::max(most.pressed_m, one.pressed_m);
                      instants.push_back({{"time_s", one.time_s},
                                          {"x_m", number_or_null(one.x_m)},
                                          {"z_m", number_or_null(one.z_m)},
                                          {"force_n", number_or_null(one.force_n)},
                                          {"deepest_m", number_or_null(one.deepest_m)},
                                          {"dent_m", number_or_null(one.dent_m)},
                                          {"pressed_m", number_or_null(one.pressed_m)}});
                    }
                    return {word("name", trace.name),
                            number("greatest_n", most.force_n, "{:.0f}", 1e-3),
                            number("deepest_m", most.deepest_m, "{:.2f}", 1e3),
                            number("dent_m", most.dent_m, "{:.0f}", 1e3),
                            number("pressed_m", most.pressed_m, "{:.0f}", 1e3),
                            stored("instants", std::move(instants)),
                            stored("obstacle", points(trace.obstacle)),
                            stored("at_touch", points(trace.at_touch)),
                            stored("at_end", points(trace.at_end))};
                  });
}

}  // namespace

nlohmann::json bench_contact(std::ostream& text) {
  nlohmann::json json;
  json["cost"] = cost_table(text);
  json["over_step"] = step_table(text);
  json["stack"] = stack_table(text);
  json["scenes"] = sweep_table(text);
  json["drawbar"] = drawbar_table(text);
  json["test_bed"] = test_bed_table(text);
  json["tracks"] = track_table(text);
  json["track_cost"] = track_cost_table(text);
  json["traces"] = trace_table(text);
  return json;
}

}  // namespace rigwire::bench
