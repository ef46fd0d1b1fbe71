#include "hil/campaign/campaign_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

#include "fields/check.h"
#include "fields/units.h"
#include "hil/campaign/spread.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/reader.h"
#include "hil/executive/clock.h"
#include "hil/files/file_content.h"

namespace rigwire::hil {

namespace {

/// Columns of tables of all runs.
constexpr std::array<std::string_view, 6> kOwnColumns{"index", "seed",          "outcome",
                                                      "what",  "first_failure", "sim_s"};

void visit_value(fields::Visitor& v, WrittenValue& value, std::string_view text) {
  v.text("value", value.text, text);
  const auto number = fields::split_quantity(value.text);
  v.check(number && std::isfinite(number->value), "value", "not a number",
          fmt::format("\"{}\"", printable(value.text)), "a number, alone or with its unit: 55 deg");
}

}  // namespace

WrittenValue::WrittenValue(double bare) : text(fields::shortest(bare)) {}

std::vector<std::string> placeholders(const std::string& word) {
  std::vector<std::string> names;
  for (std::size_t open = word.find('{'); open != std::string::npos; open = word.find('{', open)) {
    const std::size_t close = word.find('}', open);
    if (close == std::string::npos) {
      break;
    }
    names.push_back(word.substr(open + 1, close - open - 1));
    open = close;
  }
  return names;
}

void visit(fields::Visitor& v, ListedValues& p) {
  v.required("values");
  v.texts("values", p.values, "Values, as a rig's file has them.");
}

void visit(fields::Visitor& v, SteppedRange& p) {
  v.required("from");
  v.text("from", p.from, "First value, a number with its unit.");
  v.required("to");
  v.text("to", p.to, "Last value at most.");
  v.required("step");
  v.text("step", p.step, "From one value to the next, above 0.");
}

void visit(fields::Visitor& v, ValuesOfFile& p) {
  v.required("file");
  v.file("file", p.file, fields::FileKind::table, "CSV file whose first line names its columns.");
  v.required("column");
  v.text("column", p.column, "Column that has the values.");
}

void visit(fields::Visitor& v, WeightedChoice& p) {
  v.required("values");
  v.texts("values", p.values, "Values, as a rig's file has them.");
  v.required("weights");
  v.number_list("weights", p.weights, fields::plain().above(0),
                "How often each value is chosen, beside the others.");
}

void visit(fields::Visitor& v, UniformSpread& p) {
  v.required("from");
  v.text("from", p.from, "Least value, a number with its unit.");
  v.required("to");
  v.text("to", p.to, "Greatest value, in the same unit.");
}

void visit(fields::Visitor& v, LogUniformSpread& p) {
  v.required("from");
  v.text("from", p.from, "Least value, above 0, a number with its unit.");
  v.required("to");
  v.text("to", p.to, "Greatest value, in the same unit.");
}

void visit(fields::Visitor& v, NormalSpread& p) {
  v.required("mean");
  v.text("mean", p.mean, "Mean, a number with its unit.");
  v.required("deviation");
  v.text("deviation", p.deviation, "Standard deviation, above 0, in the same unit.");
  v.text("lowest", p.lowest, "Where the distribution is cut off below; empty = nowhere.");
  v.text("highest", p.highest, "Where the distribution is cut off above; empty = nowhere.");
}

void visit(fields::Visitor& v, CampaignParameter& p) {
  v.required("type");
  v.variant("type", p.spread, "How its values are spread.");
  v.texts("keys", p.keys,
          "Keys of the rig that get the value; none = the program has it as {NAME}.");
}

void validate(const CampaignParameter& p) {
  fields::check(p);
  std::visit([](const auto& spread) { check_spread(spread); }, p.spread);
}

void visit(fields::Visitor& v, ReachesCriterion& p) {
  v.required("quantity");
  v.text("quantity", p.quantity, "Word of `read`: boom; or a key of the truth: wheel_slide_mps.0.");
  v.boolean("above", p.above, "Wanted above the value, else below.");
  v.required("value");
  visit_value(v, p.value, "A number with its unit, or in the quantity's own: 55 deg.");
  v.duration("limit", p.limit, {1'000'000, 86'400'000'000'000}, "By then, from the run's start.");
}

void visit(fields::Visitor& v, StaysCriterion& p) {
  v.required("quantity");
  v.text("quantity", p.quantity, "Word of `read`: boom; or a key of the truth: wheel_slide_mps.0.");
  v.boolean("above", p.above, "Wanted above the value, else below.");
  v.required("value");
  visit_value(v, p.value, "A number with its unit, or in the quantity's own: 55 deg.");
}

void visit(fields::Visitor& v, ArrivesCriterion& p) {
  v.required("place");
  v.vector2("place", p.place_m, fields::in("m"), "[east, north] of the map's origin.");
  v.number("radius", p.radius_m, fields::in("m").above(0), "How near the first link must come.");
  v.duration("after", p.after, {0, 86'400'000'000'000},
             "Being there before does not count, from the run's start.");
}

void visit(fields::Visitor& v, ProgramExitCriterion& p) {
  v.integer("status", p.status, {}, "Exit status that is right.");
}

void visit(fields::Visitor& v, DeviceCriterion& p) {
  v.required("device");
  v.text("device", p.device, "A device of the rig, by its name.");
  v.text("figure", p.figure, "Key of its report: frames, bytes, dropped, lateness_us.p99.");
  v.boolean("above", p.above, "Wanted above the value, else below.");
  v.required("value");
  visit_value(v, p.value, "A number with its unit, or in the figure's own.");
}

void visit(fields::Visitor& v, CampaignCriterion& p) {
  v.required("type");
  v.variant("type", p.test, "What must hold.");
}

void visit(fields::Visitor& v, Campaign& p) {
  v.text("name", p.name, "For people.");
  v.text("text", p.text, "One line about it.");
  v.required("rig");
  v.text("rig", p.rig, "Rig that runs: a file, relative to this one, or a name.");
  v.texts("set", p.set, "Changes of the rig in every run: \"KEY.PATH=VALUE\".");
  v.text("clock", p.clock, "free, real or scaled:X; a field program needs one of the latter.");
  v.duration("duration", p.duration, {1'000'000, 86'400'000'000'000},
             "Simulated time of a run, at most.");
  v.duration("patience", p.patience, {1'000'000'000, 86'400'000'000'000},
             "Time of the host that a run may take.");
  v.texts("program", p.program,
          "Field program and its arguments; {NAME}, {KEY.PATH}, {index}, {seed}, {folder} and "
          "{campaign} are filled in.");
  v.choice("design", p.design, kCampaignDesigns, "Rule by which the runs are chosen.");
  v.only_if(is_sampled(p.design), "design", "design: random, latin_hypercube or sobol",
            [&](fields::Visitor& keys) {
              keys.integer("runs", p.runs, {0, 1'000'000}, "How many runs there are.");
            });
  v.integer("seed", p.seed, fields::IntegerRule{0},
            "Seed of the design, and of the seeds that the runs have.");
  v.boolean("keep_truth", p.keep_truth, "Each run keeps its ground truth, truth.jsonl.");
  v.named("parameters", p.parameters, "parameter", "What differs from run to run, by name.");
  v.named("criteria", p.criteria, "criterion", "What a run is judged by, by name.");
}

void validate(const Campaign& p) {
  fields::check(p);
  using fields::require;
  const auto clock = parse_clock_mode(p.clock);
  const bool follows =
      clock && (clock->paced() || (clock->kind == ClockMode::Kind::free && p.program.empty()));
  require(follows, "clock", p.clock,
          p.program.empty() ? "free, real or scaled:X" : "real or scaled:X with a program");
  require(!is_sampled(p.design) || p.runs > 0, "runs", "0", "1 or more");
  const bool power = (p.runs & (p.runs - 1)) == 0;
  require(p.design != CampaignDesign::sobol || power, "runs", std::to_string(p.runs),
          "a power of two with design: sobol");
  require(!p.criteria.empty(), "criteria", "none", "one or more");
  std::set<std::string> filled;
  for (const std::string& word : p.program) {
    const std::vector<std::string> names = placeholders(word);
    filled.insert(names.begin(), names.end());
  }
  std::set<std::string> keys;
  for (const auto& [name, parameter] : p.parameters) {
    const std::string path = "parameters." + name;
    require(std::ranges::count(kOwnPlaceholders, name) == 0 &&
                std::ranges::count(kOwnColumns, name) == 0,
            path, name, "a name that a run does not have itself");
    require(!parameter.keys.empty() || filled.contains(name), path + ".keys", "none",
            "a key of the rig, or {" + name + "} in the program");
    for (const std::string& key : parameter.keys) {
      require(keys.insert(key).second, path + ".keys", key, "each key once");
      require(key != "seed" && key.find('=') == std::string::npos, path + ".keys", key,
              "a key of the rig but its seed");
    }
    const bool listed = parameter.spread.index() <= 2;
    require(is_sampled(p.design) || listed, path + ".type",
            std::string(fields::chosen_name(parameter.spread)),
            "values, range or from_file with this design");
  }
  for (const auto& [name, criterion] : p.criteria) {
    require(!std::holds_alternative<ProgramExitCriterion>(criterion.test) || !p.program.empty(),
            "criteria." + name, "program_exit", "another type, or a program");
    require(!std::holds_alternative<NoSlipCriterion>(criterion.test) || (clock && clock->paced()),
            "criteria." + name, "no_slip with clock " + p.clock, "a clock that follows the wall's");
  }
}

LoadedCampaign load_campaign(const std::filesystem::path& file) {
  Problems problems;
  LoadedCampaign loaded;
  const Value document = load_document(file.string(), problems);
  if (problems.empty()) {
    read(document, loaded.campaign, problems, loaded.origins);
  }
  problems.throw_if_any();
  loaded.file = resolved_path(file);
  loaded.hash = hash_text(outline(loaded.campaign), file_content);
  return loaded;
}

}  // namespace rigwire::hil
