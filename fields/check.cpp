#include "fields/check.h"

#include <cmath>

namespace rigwire::fields {
namespace {

class Checker final : public Visitor {
 public:
  void required(std::string_view) override {}
  void refused(std::string_view, std::string_view) override {}
  void conditional(bool holds, std::string_view, std::string_view, const Part& keys) override {
    if (holds) {
      keys.show(*this);
    }
  }
  void check(bool holds, std::string_view key, const std::string& what, const std::string& found,
             const std::string& allowed) override {
    if (!holds) {
      std::string rest = what;
      rest += found.empty() ? "" : ", found " + found;
      rest += allowed.empty() ? "" : ", allowed " + allowed;
      throw Refused(std::string(key), rest);
    }
  }
  void number(std::string_view key, double& value, const NumberRule& rule,
              std::string_view) override {
    if (!std::isfinite(value) || !rule.contains(value)) {
      const std::string range = rule.range_text();
      throw Refused(std::string(key), "found " + rule.print(value) + ", allowed " +
                                          (range.empty() ? "finite numbers" : range));
    }
  }
  void numbers(std::string_view key, std::span<double> values, const NumberRule& rule,
               std::string_view text) override {
    for (std::size_t i = 0; i < values.size(); ++i) {
      number(std::string(key) + "." + std::to_string(i), values[i], rule, text);
    }
  }
  void number_list(std::string_view key, std::vector<double>& values, const NumberRule& rule,
                   std::string_view text) override {
    numbers(key, values, rule, text);
  }
  void whole(std::string_view key, std::int64_t& value, const IntegerRule& rule, bool unsigned_64,
             std::string_view) override {
    const bool beyond = unsigned_64 && value < 0;
    const bool unlimited = rule.upper == std::numeric_limits<std::int64_t>::max();
    if (beyond ? !unlimited : !rule.contains(value)) {
      const std::string number =
          beyond ? std::to_string(static_cast<std::uint64_t>(value)) : std::to_string(value);
      const std::string unit = rule.unit == nullptr ? "" : " " + std::string(rule.unit->symbol);
      throw Refused(std::string(key), "found " + number + unit + ", allowed " + rule.range_text());
    }
  }
  void boolean(std::string_view, bool&, std::string_view) override {}
  void text(std::string_view, std::string&, std::string_view) override {}
  void texts(std::string_view, std::vector<std::string>&, std::string_view) override {}
  void file(std::string_view, std::string&, FileKind, std::string_view) override {}
  void duration(std::string_view key, std::chrono::nanoseconds& value, const DurationRule& rule,
                std::string_view) override {
    if (!rule.contains(value.count())) {
      throw Refused(std::string(key),
                    "found " + print_duration(value.count()) + ", allowed " + rule.range_text());
    }
  }
  void rate(std::string_view key, std::chrono::nanoseconds& period, const NumberRule& rule,
            std::string_view) override {
    const double hertz = period.count() > 0 ? 1e9 / static_cast<double>(period.count()) : 0.0;
    // The period of a bound is rounded to a nanosecond, so that its rate may lie just beyond.
    const double nearest = period.count() > 0 ? std::round(1e9 / rule.upper()) : 0.0;
    const bool is_upper = std::isfinite(rule.upper()) && hertz > 0.0 &&
                          static_cast<double>(period.count()) == nearest;
    if (period.count() <= 0 || (!is_upper && !rule.contains(hertz))) {
      throw Refused(std::string(key), "found a period of " + print_duration(period.count()) +
                                          ", allowed rates " + rule.range_text());
    }
  }
  void spelled(std::string_view key, const Spelling& spelling, std::string_view) override {
    try {
      spelling.parse(spelling.print());
    } catch (const std::invalid_argument& error) {
      throw Refused(std::string(key), error.what());
    }
  }
  void pick(std::string_view key, std::size_t& index, std::span<const Named> names,
            std::string_view) override {
    if (index >= names.size()) {
      std::string allowed;
      for (const Named& named : names) {
        allowed += (allowed.empty() ? "" : ", ") + std::string(named.name);
      }
      throw Refused(std::string(key), "holds none of its names, allowed " + allowed);
    }
  }
  void part(std::string_view key, const Part& part, std::string_view) override {
    within(std::string(key), part);
  }
  void elements(std::string_view key, Elements& list, std::string_view) override {
    for (std::size_t i = 0; i < list.size(); ++i) {
      within(std::string(key) + "." + std::to_string(i), list.at(i));
    }
  }
  void members(std::string_view key, Members& map, std::string_view, std::string_view) override {
    for (const std::string& name : map.names()) {
      within(std::string(key) + "." + name, map.at(name));
    }
  }
  void alternatives(std::string_view, Alternatives& types, std::string_view) override {
    within("", types.chosen());
  }

 private:
  void within(const std::string& key, const Part& part) {
    try {
      if (part.has_validate()) {
        part.validate();
      } else {
        part.show(*this);
      }
    } catch (const Refused& refused) {
      const bool both = !key.empty() && !refused.path().empty();
      throw Refused(key + (both ? "." : "") + refused.path(), refused.rest());
    } catch (const std::invalid_argument& error) {
      throw Refused(key, error.what());
    }
  }
};

}  // namespace

Refused::Refused(std::string path, const std::string& rest)
    : std::invalid_argument(path.empty() ? rest : path + ": " + rest),
      path_(std::move(path)),
      rest_(rest) {}

void check_part(const Part& part) {
  Checker checker;
  part.show(checker);
}

void require(bool holds, std::string path, const std::string& found, const std::string& allowed) {
  if (!holds) {
    throw Refused(std::move(path), "found " + found + ", allowed " + allowed);
  }
}

}  // namespace rigwire::fields
