#include "hil/campaign/campaign_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {

namespace {

constexpr std::size_t kClasses = 4;
constexpr std::size_t kWorst = 10;
constexpr std::size_t kMostDrives = 1000;  // in a picture

bool is_judged(const CampaignRow& row) {
  return row.outcome == Outcome::passed || row.outcome == Outcome::failed;
}

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// A word without spaces as "#" when it is a number, with its unit behind it where it has one:
/// "12.5", "-1e-05", "0-19", "3s". Names with digits stay: "position_m.0", "m3ps".
std::string without_number(std::string_view word) {
  const std::size_t sign = word.starts_with('-') ? 1 : 0;
  if (word.size() == sign || !is_digit(word[sign])) {
    return std::string(word);
  }
  double ignored = 0.0;
  const char* const end = word.data() + word.size();
  const char* const after = std::from_chars(word.data() + sign, end, ignored).ptr;
  const std::string_view rest(after, static_cast<std::size_t>(end - after));
  if (std::ranges::all_of(rest, is_letter)) {
    return "#" + std::string(rest);
  }
  return std::ranges::any_of(rest, is_letter) ? std::string(word) : "#";
}

/// Replaces every number that is a word of its own by "#", so that texts that differ in such
/// numbers only become equal.
std::string without_numbers(std::string_view text) {
  const auto belongs = [](char c) { return is_digit(c) || is_letter(c) || c == '.' || c == '-'; };
  std::string general;
  for (std::size_t i = 0; i < text.size();) {
    if (!belongs(text[i])) {
      general += text[i++];
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && belongs(text[end])) {
      ++end;
    }
    std::size_t stop = end;  // without what ends a sentence
    while (stop > i + 1 && !is_digit(text[stop - 1]) && !is_letter(text[stop - 1])) {
      --stop;
    }
    general += without_number(text.substr(i, stop - i));
    general += text.substr(stop, end - stop);
    i = end;
  }
  return general;
}

std::optional<std::size_t> column_of(const CampaignTable& table, const std::string& name) {
  const auto found = std::ranges::find(table.plan.parameters, name);
  return found == table.plan.parameters.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - table.plan.parameters.begin()));
}

/// Numbers of a column by row; nothing when any value is a word, or they have several units.
struct NumericColumn {
  std::string name;
  std::string unit;
  std::vector<double> numbers;
};
std::optional<NumericColumn> numeric_column(const CampaignTable& table, std::size_t column) {
  NumericColumn result{table.plan.parameters[column], {}, {}};
  for (const CampaignRow& row : table.rows) {
    const auto value = numeric(row.values[column]);
    if (!value || (!result.numbers.empty() && value->unit != result.unit)) {
      return std::nullopt;
    }
    result.unit = value->unit;
    result.numbers.push_back(value->number);
  }
  return result;
}

/// Bounds between classes of equal size; as few as there are different numbers.
std::vector<double> class_bounds(std::vector<double> numbers) {
  std::ranges::sort(numbers);
  std::vector<double> bounds;
  for (std::size_t i = 1; i < kClasses; ++i) {
    const double bound = numbers[i * numbers.size() / kClasses];
    if (bound > numbers.front() && (bounds.empty() || bound > bounds.back())) {
      bounds.push_back(bound);
    }
  }
  return bounds;
}

void add_numeric_classes(const CampaignTable& table, const NumericColumn& column,
                         std::vector<ValueClass>& classes) {
  const std::vector<double> bounds = class_bounds(column.numbers);
  struct Class {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
    std::size_t passed = 0;
    std::size_t judged = 0;
  };
  std::vector<Class> found(bounds.size() + 1);
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const double number = column.numbers[i];
    const auto above = std::ranges::upper_bound(bounds, number);
    Class& its = found[static_cast<std::size_t>(above - bounds.begin())];
    its.least = std::min(its.least, number);
    its.greatest = std::max(its.greatest, number);
    its.judged += is_judged(table.rows[i]) ? 1 : 0;
    its.passed += table.rows[i].outcome == Outcome::passed ? 1 : 0;
  }
  for (const Class& its : found) {
    const std::string range = its.least == its.greatest
                                  ? fmt::format("{:.4g}", its.least)
                                  : fmt::format("{:.4g} .. {:.4g}", its.least, its.greatest);
    classes.push_back({column.name, range + (column.unit.empty() ? "" : " " + column.unit),
                       its.passed, its.judged});
  }
}

void add_word_classes(const CampaignTable& table, std::size_t column,
                      std::vector<ValueClass>& classes) {
  std::map<std::string, ValueClass> found;
  for (const CampaignRow& row : table.rows) {
    const std::string& word = row.values[column];
    ValueClass& its = found[word];
    its.parameter = table.plan.parameters[column];
    its.values = word.empty() ? "the rig's own" : word;
    its.judged += is_judged(row) ? 1 : 0;
    its.passed += row.outcome == Outcome::passed ? 1 : 0;
  }
  for (auto& [word, its] : found) {
    classes.push_back(std::move(its));
  }
}

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::string rate_text(std::size_t passed, std::size_t judged) {
  if (judged == 0) {
    return "none judged";
  }
  const ShareInterval interval = wilson_interval(passed, judged);
  return fmt::format("{} of {}, {} ({} .. {})", passed, judged,
                     percent(static_cast<double>(passed) / static_cast<double>(judged)),
                     percent(interval.lower), percent(interval.upper));
}

std::string failure_text(const CampaignRow& row) {
  if (row.outcome == Outcome::crashed) {
    return "crashed: " + row.what;
  }
  const Verdict& verdict = row.verdicts.at(*row.first_failure);
  return fmt::format("{}: {}{}{}", *row.first_failure,
                     verdict.at_s ? fmt::format("at {:.2f} s ", *verdict.at_s) : "", verdict.text,
                     verdict.detail.empty() ? "" : ", " + verdict.detail);
}

std::string values_text(const CampaignTable& table, const CampaignRow& row) {
  std::string text;
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    if (!row.values[i].empty()) {
      text += (text.empty() ? "" : ", ") + table.plan.parameters[i] + " " + row.values[i];
    }
  }
  return text;
}

std::string outcomes_text(const CampaignTable& table) {
  std::string text;
  for (std::size_t i = 0; i < kOutcomes.size(); ++i) {
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", table.count(static_cast<Outcome>(i)),
                        kOutcomes[i]);
  }
  return text;
}

std::size_t judged_of(const CampaignTable& table) {
  return table.count(Outcome::passed) + table.count(Outcome::failed);
}

std::string runs_text(const std::vector<std::size_t>& runs) {
  constexpr std::size_t kTold = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(runs.size(), kTold); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", runs[i]);
  }
  return text + (runs.size() > kTold ? ", ..." : "");
}

std::string escaped(const std::string& text) {
  std::string html;
  for (const char c : printable(text, "\n")) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

constexpr std::string_view kStyle = R"(<style>
:root { --ink: #1b1f24; --quiet: #6a737d; --line: #d8dde3; --good: #2a7f62; --bad: #c0392b; --paper: #fff; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e9ed; --quiet: #98a2ad; --line: #39414a; --good: #5fbf9b; --bad: #ff7b6b; --paper: #15191e; }
}
body { font: 15px/1.45 system-ui, sans-serif; color: var(--ink); background: var(--paper);
       max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: left; vertical-align: top; padding: .3rem .6rem; border-bottom: 1px solid var(--line); }
th { color: var(--quiet); font-weight: 600; } td.number { text-align: right; font-variant-numeric: tabular-nums; }
code { font: 13px ui-monospace, monospace; } .quiet { color: var(--quiet); }
.pictures { display: flex; flex-wrap: wrap; gap: 2rem; } figure { margin: 0; flex: 1 1 26rem; }
svg { width: 100%; height: auto; } svg text { font: 12px system-ui, sans-serif; fill: var(--quiet); }
.axis { stroke: var(--line); } .passed { color: var(--good); } .failed { color: var(--bad); }
.bar { fill: var(--line); } .interval { stroke: var(--ink); stroke-width: 2; } .rate { fill: var(--ink); }
</style>
)";

/// From two ranges of numbers to a picture of 520 x 400 with room for the axes.
class Axes {
 public:
  static constexpr double kWidth = 520.0;
  static constexpr double kHeight = 400.0;

  void include(double x, double y) {
    x_[0] = std::min(x_[0], x);
    x_[1] = std::max(x_[1], x);
    y_[0] = std::min(y_[0], y);
    y_[1] = std::max(y_[1], y);
  }
  /// A margin, and some width where all numbers are one.
  void widen(double least_width) {
    for (auto* range : {&x_, &y_}) {
      const double width = std::max((*range)[1] - (*range)[0], least_width);
      (*range)[0] -= 0.04 * width;
      (*range)[1] += 0.04 * width;
    }
  }
  /// A metre is as long upwards as to the side.
  void make_equal() {
    const double scale = std::max((x_[1] - x_[0]) / kInnerWidth, (y_[1] - y_[0]) / kInnerHeight);
    grow(x_, scale * kInnerWidth);
    grow(y_, scale * kInnerHeight);
  }
  [[nodiscard]] double x(double value) const {
    return kLeft + kInnerWidth * (value - x_[0]) / (x_[1] - x_[0]);
  }
  [[nodiscard]] double y(double value) const {
    return kTop + kInnerHeight * (1.0 - (value - y_[0]) / (y_[1] - y_[0]));
  }
  /// Frame, names and the numbers at its corners.
  [[nodiscard]] std::string frame(const std::string& x_name, const std::string& y_name) const {
    return fmt::format(
        R"(<rect x="{0}" y="{1}" width="{2}" height="{3}" fill="none" class="axis"/>)"
        R"(<text x="{0}" y="{4}">{5:.4g}</text><text x="{6}" y="{4}" text-anchor="end">{7:.4g}</text>)"
        R"(<text x="{8}" y="{4}" text-anchor="middle">{9}</text>)"
        R"(<text x="{10}" y="{11}" text-anchor="end">{12:.4g}</text>)"
        R"(<text x="{10}" y="{13}" text-anchor="end">{14:.4g}</text>)"
        R"(<text x="{0}" y="{15}">{16}</text>)",
        kLeft, kTop, kInnerWidth, kInnerHeight, kHeight - 8, x_[0], kLeft + kInnerWidth, x_[1],
        kLeft + kInnerWidth / 2, escaped(x_name), kLeft - 6, kTop + 10, y_[1], kTop + kInnerHeight,
        y_[0], kTop - 8, escaped(y_name));
  }

 private:
  static constexpr double kLeft = 60.0;
  static constexpr double kTop = 24.0;
  static constexpr double kInnerWidth = kWidth - kLeft - 12.0;
  static constexpr double kInnerHeight = kHeight - kTop - 28.0;

  static void grow(std::array<double, 2>& range, double width) {
    const double middle = 0.5 * (range[0] + range[1]);
    range = {middle - 0.5 * width, middle + 0.5 * width};
  }

  std::array<double, 2> x_{std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
  std::array<double, 2> y_ = x_;
};

std::string svg(const std::string& content, const std::string& caption) {
  return fmt::format(
      "<figure><svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>"
      "<figcaption class=\"quiet\">{}</figcaption></figure>\n",
      Axes::kWidth, Axes::kHeight, escaped(caption), content, escaped(caption));
}

std::string outcome_class(const CampaignRow& row) {
  return row.outcome == Outcome::passed ? "passed" : "failed";
}

std::string drives_picture(const CampaignTable& table) {
  std::vector<const CampaignRow*> drawn;
  Axes axes;
  for (const CampaignRow& row : table.rows) {
    if (is_judged(row) && !row.track.empty() && drawn.size() < kMostDrives) {
      drawn.push_back(&row);
      for (const auto& [at_s, east_m, north_m] : row.track) {
        axes.include(east_m, north_m);
      }
    }
  }
  if (drawn.empty()) {
    return "";
  }
  axes.widen(1.0);
  axes.make_equal();
  // What failed lies above.
  std::ranges::stable_sort(drawn, {}, [](const CampaignRow* row) { return row->outcome; });
  std::string content = axes.frame("east (m)", "north (m)");
  for (const CampaignRow* row : drawn) {
    std::string points;
    for (const auto& [at_s, east_m, north_m] : row->track) {
      points += fmt::format("{:.1f},{:.1f} ", axes.x(east_m), axes.y(north_m));
    }
    const auto& [at_s, east_m, north_m] = row->track.back();
    content += fmt::format(
        R"(<g class="{}"><title>run {}</title><polyline points="{}" fill="none" stroke="currentColor" stroke-opacity="0.45"/>)"
        R"(<circle cx="{:.1f}" cy="{:.1f}" r="2.5" fill="currentColor"/></g>)",
        outcome_class(*row), row->index, points, axes.x(east_m), axes.y(north_m));
  }
  return svg(content, "Drives from above, each with a dot at its end: passed green, failed red");
}

std::string scatter_picture(const CampaignTable& table, const NumericColumn& x,
                            const NumericColumn& y) {
  Axes axes;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    axes.include(x.numbers[i], y.numbers[i]);
  }
  axes.widen(1e-6);
  const auto name = [](const NumericColumn& column) {
    return column.unit.empty() ? column.name : column.name + " (" + column.unit + ")";
  };
  std::string content = axes.frame(name(x), name(y));
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const CampaignRow& row = table.rows[i];
    if (row.outcome == Outcome::missing || row.outcome == Outcome::unfinished) {
      continue;
    }
    const double px = axes.x(x.numbers[i]);
    const double py = axes.y(y.numbers[i]);
    // A shape beside the colour, for readers who cannot distinguish the colours.
    const std::string shape =
        row.outcome == Outcome::passed
            ? fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4" fill="currentColor"/>)", px, py)
            : fmt::format(
                  R"(<path d="M{:.1f},{:.1f}l8,8m0,-8l-8,8" stroke="currentColor" stroke-width="2.2"/>)",
                  px - 4, py - 4);
    content += fmt::format(R"(<g class="{}" fill-opacity="0.7"><title>run {}: {}</title>{}</g>)",
                           outcome_class(row), row.index, escaped(values_text(table, row)), shape);
  }
  return svg(content,
             fmt::format("{} and {}: passed a dot, failed or crashed a cross", x.name, y.name));
}

/// How much the pass rate differs between the classes of each parameter, the widest first.
std::vector<std::string> by_influence(const std::vector<ValueClass>& classes) {
  struct Ends {
    double least = 1.0;
    double greatest = 0.0;
  };
  std::map<std::string, Ends> found;
  for (const ValueClass& its : classes) {
    if (its.judged > 0) {
      const double rate = static_cast<double>(its.passed) / static_cast<double>(its.judged);
      Ends& ends = found[its.parameter];
      ends.least = std::min(ends.least, rate);
      ends.greatest = std::max(ends.greatest, rate);
    }
  }
  std::vector<std::string> names;
  for (const auto& [name, ends] : found) {
    names.push_back(name);
  }
  std::ranges::stable_sort(names, std::greater<>{}, [&](const std::string& name) {
    return found[name].greatest - found[name].least;
  });
  return names;
}

std::vector<NumericColumn> chosen_axes(const CampaignTable& table,
                                       const std::vector<std::string>& wanted) {
  std::vector<NumericColumn> axes;
  for (const std::string& name : wanted) {
    const auto column = column_of(table, name);
    auto numbers = column ? numeric_column(table, *column) : std::nullopt;
    if (!numbers) {
      throw std::invalid_argument(
          fmt::format("--axes: {}, found \"{}\", allowed {}",
                      column ? "has values that are no numbers of one unit" : "no such parameter",
                      printable(name), join_words(table.plan.parameters)));
    }
    axes.push_back(std::move(*numbers));
  }
  if (wanted.empty()) {
    for (const std::string& name : by_influence(classes_of(table))) {
      auto numbers = numeric_column(table, column_of(table, name).value());
      if (numbers && axes.size() < 2) {
        axes.push_back(std::move(*numbers));
      }
    }
  }
  return axes;
}

/// The rate of a class as a bar with its interval.
std::string rate_bar(const ValueClass& its) {
  if (its.judged == 0) {
    return "";
  }
  const ShareInterval interval = wilson_interval(its.passed, its.judged);
  const double rate = static_cast<double>(its.passed) / static_cast<double>(its.judged);
  return fmt::format(
      R"(<svg viewBox="-5 0 210 14" style="max-width:14rem"><rect class="bar" y="5" width="200" height="4"/>)"
      R"(<line class="interval" x1="{:.1f}" x2="{:.1f}" y1="7" y2="7"/><circle class="rate" cx="{:.1f}" cy="7" r="4"/></svg>)",
      200 * interval.lower, 200 * interval.upper, 200 * rate);
}

std::string row_of(const std::vector<std::string>& cells) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) {
    row += "<td>" + cell + "</td>";
  }
  return row + "</tr>\n";
}

}  // namespace

ShareInterval wilson_interval(std::size_t passed, std::size_t all) {
  if (all == 0) {
    return {};
  }
  constexpr double kQuantile = 1.959963984540054;  // of 97.5 %
  const auto n = static_cast<double>(all);
  const double share = static_cast<double>(passed) / n;
  const double square = kQuantile * kQuantile;
  const double middle = (share + square / (2.0 * n)) / (1.0 + square / n);
  const double half = kQuantile / (1.0 + square / n) *
                      std::sqrt(share * (1.0 - share) / n + square / (4.0 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::vector<ValueClass> classes_of(const CampaignTable& table) {
  std::vector<ValueClass> classes;
  for (std::size_t i = 0; i < table.plan.parameters.size(); ++i) {
    if (const auto numbers = numeric_column(table, i)) {
      add_numeric_classes(table, *numbers, classes);
    } else {
      add_word_classes(table, i, classes);
    }
  }
  return classes;
}

std::vector<FailureGroup> failure_groups(const CampaignTable& table) {
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> found;
  for (const CampaignRow& row : table.rows) {
    if (row.outcome == Outcome::crashed) {
      found[{"", without_numbers(row.what)}].push_back(row.index);
    } else if (row.outcome == Outcome::failed) {
      const Verdict& verdict = row.verdicts.at(row.first_failure.value());
      found[{*row.first_failure, verdict.text}].push_back(row.index);
    }
  }
  std::vector<FailureGroup> groups;
  for (auto& [what, runs] : found) {
    groups.push_back({what.first, what.second, std::move(runs)});
  }
  std::ranges::stable_sort(groups, std::greater<>{},
                           [](const FailureGroup& group) { return group.runs.size(); });
  return groups;
}

std::vector<const CampaignRow*> worst_runs(const CampaignTable& table) {
  std::vector<const CampaignRow*> worst;
  for (const CampaignRow& row : table.rows) {
    if (row.outcome == Outcome::crashed || row.outcome == Outcome::failed) {
      worst.push_back(&row);
    }
  }
  const auto key = [](const CampaignRow* row) {
    const auto kept = std::ranges::count_if(
        row->verdicts, [](const auto& verdict) { return verdict.second.passed; });
    const auto failed = static_cast<std::ptrdiff_t>(row->verdicts.size()) - kept;
    const double at_s =
        row->first_failure
            ? row->verdicts.at(*row->first_failure).at_s.value_or(row->sim_s.value_or(0.0))
            : 0.0;
    return std::tuple(row->outcome != Outcome::crashed, -failed, at_s);
  };
  std::ranges::stable_sort(worst, {}, key);
  worst.resize(std::min(worst.size(), kWorst));
  return worst;
}

std::string run_again(const CampaignPlan& plan, std::size_t index) {
  return fmt::format("rigwire campaign run {} --index {} -o again", printable(plan.file.string()),
                     index);
}

std::string report_text(const CampaignTable& table) {
  std::string text = fmt::format("{}: {} runs, {}\npassed: {} (95 % interval after Wilson)\n",
                                 table.plan.name, table.rows.size(), outcomes_text(table),
                                 rate_text(table.count(Outcome::passed), judged_of(table)));
  if (const auto groups = failure_groups(table); !groups.empty()) {
    text += "\nFailures by their first event\n";
    for (const FailureGroup& group : groups) {
      text += fmt::format("  {:5}  {}: {} (runs {})\n", group.runs.size(),
                          group.criterion.empty() ? "crashed" : group.criterion, group.text,
                          runs_text(group.runs));
    }
  }
  if (const auto classes = classes_of(table); !classes.empty()) {
    text += "\nPassed, by parameter\n";
    for (const ValueClass& its : classes) {
      text += fmt::format("  {}  {}: {}\n", its.parameter, its.values,
                          rate_text(its.passed, its.judged));
    }
  }
  if (const auto worst = worst_runs(table); !worst.empty()) {
    text += "\nThe worst, and how to run each again\n";
    for (const CampaignRow* row : worst) {
      text += fmt::format("  run {}: {}\n    {}\n    {}\n", row->index, failure_text(*row),
                          values_text(table, *row), run_again(table.plan, row->index));
    }
  }
  return text;
}

std::string report_page(const CampaignTable& table, const std::vector<std::string>& axes) {
  const std::string name = escaped(table.plan.name);
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>" +
      name + "</title>\n" + std::string(kStyle) + "</head><body>\n<h1>" + name + "</h1>\n";
  page += fmt::format(
      "<p><strong>Passed: {}</strong> <span class=\"quiet\">95 % interval after Wilson, of the "
      "judged runs</span><br>{} runs: {}</p>\n",
      rate_text(table.count(Outcome::passed), judged_of(table)), table.rows.size(),
      outcomes_text(table));
  page += "<div class=\"pictures\">\n" + drives_picture(table);
  const std::vector<NumericColumn> columns = chosen_axes(table, axes);
  if (columns.size() == 2) {
    page += scatter_picture(table, columns[0], columns[1]);
  }
  page += "</div>\n";
  if (const auto groups = failure_groups(table); !groups.empty()) {
    page +=
        "<h2>Failures by their first event</h2>\n<table><tr><th>runs</th><th>criterion</th>"
        "<th>what</th><th>which</th></tr>\n";
    for (const FailureGroup& group : groups) {
      page += row_of({std::to_string(group.runs.size()),
                      group.criterion.empty() ? "crashed" : escaped(group.criterion),
                      escaped(group.text), runs_text(group.runs)});
    }
    page += "</table>\n";
  }
  if (const auto classes = classes_of(table); !classes.empty()) {
    page +=
        "<h2>Passed, by parameter</h2>\n<table><tr><th>parameter</th><th>values</th>"
        "<th>passed</th><th>0 to 100 %</th></tr>\n";
    for (const ValueClass& its : classes) {
      page += row_of({escaped(its.parameter), escaped(its.values),
                      rate_text(its.passed, its.judged), rate_bar(its)});
    }
    page += "</table>\n";
  }
  if (const auto worst = worst_runs(table); !worst.empty()) {
    page +=
        "<h2>The worst, and how to run each again</h2>\n<table><tr><th>run</th><th>what</th>"
        "<th>parameters</th></tr>\n";
    for (const CampaignRow* row : worst) {
      page += row_of({std::to_string(row->index),
                      escaped(failure_text(*row)) + "<br><code>" +
                          escaped(run_again(table.plan, row->index)) + "</code>",
                      escaped(values_text(table, *row))});
    }
    page += "</table>\n";
  }
  return page + "</body></html>\n";
}

}  // namespace rigwire::hil
