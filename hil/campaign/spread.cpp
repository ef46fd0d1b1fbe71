#include "hil/campaign/spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "fields/units.h"
#include "hil/campaign/csv_table.h"
#include "hil/configuration/plain_text.h"

namespace rigwire::hil {

namespace {

constexpr double kMostValues = 1e6;

[[noreturn]] void refuse(const std::string& key, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument(
      fmt::format("{}: found \"{}\", allowed {}", key, printable(found), allowed));
}

struct Measure {
  double value = 0.0;
  std::string unit;
};

Measure measure(const std::string& key, const std::string& text) {
  const auto quantity = fields::split_quantity(text);
  if (!quantity || !std::isfinite(quantity->value)) {
    refuse(key, text, "a number with its unit: 2.5 bar");
  }
  return {quantity->value, std::string(quantity->unit)};
}

/// Returns the value of `text`, which must have the unit `unit`; refuses any other unit.
double measure_in(const std::string& key, const std::string& text, const std::string& unit) {
  const Measure found = measure(key, text);
  if (found.unit != unit) {
    refuse(key, text, unit.empty() ? "a bare number as beside it" : "a number in " + unit);
  }
  return found.value;
}

std::string written(double value, const std::string& unit) {
  return fmt::format("{:.9g}{}{}", value, unit.empty() ? "" : " ", unit);
}

struct Span {
  double from = 0.0;
  double to = 0.0;
  std::string unit;
};

template <class Spread>
Span span_of(const Spread& p) {
  const Measure from = measure("from", p.from);
  const double to = measure_in("to", p.to, from.unit);
  if (!(from.value < to)) {
    refuse("to", p.to, "more than " + p.from);
  }
  return {from.value, to, from.unit};
}

/// Number of steps, the last value included; a step that ends a billionth short of it arrives.
std::size_t steps_of(const Span& span, double step) {
  return static_cast<std::size_t>(std::floor((span.to - span.from) / step + 1e-9));
}

double step_of(const SteppedRange& p, const Span& span) {
  const double step = measure_in("step", p.step, span.unit);
  if (!(step > 0.0) || (span.to - span.from) / step > kMostValues) {
    refuse("step", p.step, "above 0, and a million values at most");
  }
  return step;
}

/// Distribution function of the standard normal distribution.
double normal_share(double deviations) {
  return 0.5 * std::erfc(-deviations / std::numbers::sqrt2);
}

struct Normal {
  double mean = 0.0;
  double deviation = 1.0;
  double least_share = 0.0;
  double greatest_share = 1.0;
  std::string unit;
};

Normal normal_of(const NormalSpread& p) {
  const Measure mean = measure("mean", p.mean);
  Normal normal{.mean = mean.value,
                .deviation = measure_in("deviation", p.deviation, mean.unit),
                .least_share = 0.0,
                .greatest_share = 1.0,
                .unit = mean.unit};
  if (!(normal.deviation > 0.0)) {
    refuse("deviation", p.deviation, "above 0");
  }
  const auto share = [&](const char* key, const std::string& text) {
    return normal_share((measure_in(key, text, mean.unit) - normal.mean) / normal.deviation);
  };
  if (!p.lowest.empty()) {
    normal.least_share = share("lowest", p.lowest);
  }
  if (!p.highest.empty()) {
    normal.greatest_share = share("highest", p.highest);
  }
  constexpr double kLeastKept = 1e-9;
  if (normal.greatest_share - normal.least_share < kLeastKept) {
    refuse("highest", p.highest, "something of the distribution above " + p.lowest);
  }
  return normal;
}

void check_values(const std::vector<std::string>& values) {
  if (values.empty()) {
    refuse("values", "", "one or more");
  }
}

std::vector<std::string> column_of(const ValuesOfFile& p) {
  return read_csv(p.file).column(p.column);
}

std::vector<std::string> list_of(const ListedValues& p) {
  return p.values;
}

std::vector<std::string> list_of(const ValuesOfFile& p) {
  return column_of(p);
}

std::vector<std::string> list_of(const SteppedRange& p) {
  const Span span = span_of(p);
  const double step = step_of(p, span);
  std::vector<std::string> values;
  for (std::size_t i = 0; i <= steps_of(span, step); ++i) {
    values.push_back(written(span.from + static_cast<double>(i) * step, span.unit));
  }
  return values;
}

template <class Spread>
concept Listed = requires(const Spread& spread) {
  list_of(spread);
};

template <Listed Spread>
std::string quantile(const Spread& p, double place) {
  return element_at(list_of(p), place);
}

std::string quantile(const WeightedChoice& p, double place) {
  double left = place * std::accumulate(p.weights.begin(), p.weights.end(), 0.0);
  std::size_t i = 0;
  while (i + 1 < p.values.size() && left >= p.weights[i]) {
    left -= p.weights[i++];
  }
  return p.values[i];
}

std::string quantile(const UniformSpread& p, double place) {
  const Span span = span_of(p);
  return written(span.from + place * (span.to - span.from), span.unit);
}

std::string quantile(const LogUniformSpread& p, double place) {
  const Span span = span_of(p);
  return written(span.from * std::pow(span.to / span.from, place), span.unit);
}

std::string quantile(const NormalSpread& p, double place) {
  const Normal normal = normal_of(p);
  const double share = normal.least_share + place * (normal.greatest_share - normal.least_share);
  return written(normal.mean + normal.deviation * normal_quantile(share), normal.unit);
}

}  // namespace

void check_spread(const ListedValues& p) {
  check_values(p.values);
}

void check_spread(const SteppedRange& p) {
  static_cast<void>(step_of(p, span_of(p)));
}

void check_spread(const ValuesOfFile& p) {
  static_cast<void>(column_of(p));
}

void check_spread(const WeightedChoice& p) {
  check_values(p.values);
  if (p.weights.size() != p.values.size()) {
    refuse("weights", fmt::format("{} numbers", p.weights.size()),
           fmt::format("{}, as there are values", p.values.size()));
  }
}

void check_spread(const UniformSpread& p) {
  static_cast<void>(span_of(p));
}

void check_spread(const LogUniformSpread& p) {
  if (!(span_of(p).from > 0.0)) {
    refuse("from", p.from, "above 0");
  }
}

void check_spread(const NormalSpread& p) {
  static_cast<void>(normal_of(p));
}

std::optional<std::vector<std::string>> listed_values(const CampaignParameter& parameter) {
  return std::visit(
      [](const auto& spread) -> std::optional<std::vector<std::string>> {
        if constexpr (Listed<std::decay_t<decltype(spread)>>) {
          return list_of(spread);
        } else {
          return std::nullopt;
        }
      },
      parameter.spread);
}

const std::string& element_at(const std::vector<std::string>& list, double place) {
  const auto count = static_cast<double>(list.size());
  return list[std::min(list.size() - 1, static_cast<std::size_t>(place * count))];
}

std::string value_at(const CampaignParameter& parameter, double place) {
  return std::visit([&](const auto& spread) { return quantile(spread, place); }, parameter.spread);
}

double normal_quantile(double place) {
  double lower = -8.3;  // beyond it 1 - share is no double below 1
  double upper = 8.3;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (lower + upper);
    (normal_share(middle) < place ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

}  // namespace rigwire::hil
