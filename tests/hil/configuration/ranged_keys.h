// The keys of a structure that have a range, each with values at the ends of it and just outside,
// and the documents that bring each of them about: every list gets an element, every alternative
// and every choice is taken once.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/outline.h"

namespace rigwire::hil {

enum class End { lower, upper };

/// A value at an end or beside it, as a file writes it, and whether the rule allows it.
struct Attempt {
  End end;
  std::string written;
  bool is_allowed;
};

struct RangedKey {
  std::string label;  ///< Its path, with the names of the types that were chosen on the way.
  std::string path;   ///< Its path as a document has it.
  std::string range;
  std::string unit;                     ///< Unit of a bare number.
  std::vector<std::string> components;  ///< What a list of numbers holds; empty for one number.
  std::vector<Attempt> attempts;        ///< Tried on each component.

  /// Two keys of one identity have one rule.
  [[nodiscard]] std::string identity() const { return label + ": " + range + " " + unit; }
};

/// A place where a structure has several forms.
struct Fork {
  std::string label;
  std::size_t count;
  std::size_t chosen;
};

/// Number of the chosen form, by the fork's label.
using Forms = std::map<std::string, std::size_t>;

/// An open end is refused and a value just inside allowed; nothing is tried where there is no end.
inline std::vector<Attempt> attempts_of(const fields::NumberRule& rule) {
  const double width = rule.upper() - rule.lower();
  const auto text = [&rule](double value) {
    const bool bare = rule.written().symbol == "1" || rule.written().symbol.empty();
    return fields::shortest(value) + (bare ? "" : " " + std::string(rule.written().symbol));
  };
  const auto step = [width](double bound) {
    constexpr double kShare = 1e-9;      // of the range: no device tells such values apart
    constexpr double kRounding = 1e-14;  // more than conversion between units loses
    const double size = std::isfinite(width) ? width : std::max(1.0, std::fabs(bound));
    return std::max(kShare * size, kRounding * std::fabs(bound));
  };
  std::vector<Attempt> attempts;
  if (std::isfinite(rule.lower())) {
    const double near = step(rule.lower());
    attempts.push_back({End::lower, text(rule.lower()), !rule.lower_is_open()});
    if (rule.lower_is_open()) {
      attempts.push_back({End::lower, text(rule.lower() + near), true});
    }
    attempts.push_back({End::lower, text(rule.lower() - near), false});
  }
  if (std::isfinite(rule.upper())) {
    attempts.push_back({End::upper, text(rule.upper()), true});
    attempts.push_back({End::upper, text(rule.upper() + step(rule.upper())), false});
  }
  return attempts;
}

/// Attempts at whole numbers; `step` is the least that a file can tell apart.
template <class Step>
std::vector<Attempt> attempts_of(std::int64_t lower, std::int64_t upper, std::string_view unit,
                                 Step step) {
  using Limits = std::numeric_limits<std::int64_t>;
  std::vector<Attempt> attempts;
  const auto add = [&](End end, std::int64_t value, bool is_allowed) {
    attempts.push_back({end, std::to_string(value) + std::string(unit), is_allowed});
  };
  if (lower != Limits::min()) {
    add(End::lower, lower, true);
    add(End::lower, lower - step(lower), false);
  }
  if (upper != Limits::max()) {
    add(End::upper, upper, true);
    add(End::upper, upper + step(upper), false);
  }
  return attempts;
}

/// Walks the keys. With forms to take it also changes the structure: each fork that they name takes
/// that form, and what is empty gets an element.
class RangedKeys final : public fields::Visitor {
 public:
  /// Does not look under the `skipped` keys of the top.
  RangedKeys(std::span<const std::string_view> skipped, const Forms* forms)
      : skipped_(skipped), forms_(forms) {}

  /// Puts the value, which a file would refuse, into the member of that path (with the component's
  /// number), where the member's type can hold it.
  void plant(std::string path, std::string written) {
    planted_path_ = std::move(path);
    planted_ = std::move(written);
  }
  [[nodiscard]] bool has_planted() const { return has_planted_; }

  [[nodiscard]] const std::vector<RangedKey>& keys() const { return keys_; }
  [[nodiscard]] const std::vector<Fork>& forks() const { return forks_; }

  void required(std::string_view) override {}
  void refused(std::string_view, std::string_view) override {}
  void conditional(bool holds, std::string_view, std::string_view,
                   const fields::Part& keys) override {
    if (holds) {
      keys.show(*this);
    }
  }
  void check(bool, std::string_view, const std::string&, const std::string&,
             const std::string&) override {}
  void boolean(std::string_view key, bool& value, std::string_view) override {
    value = form(key, 2, value ? 1 : 0) == 1;
  }
  void text(std::string_view, std::string&, std::string_view) override {}
  void texts(std::string_view, std::vector<std::string>&, std::string_view) override {}
  void file(std::string_view, std::string&, fields::FileKind, std::string_view) override {}
  void spelled(std::string_view, const fields::Spelling&, std::string_view) override {}

  void number(std::string_view key, double& value, const fields::NumberRule& rule,
              std::string_view) override {
    add(key, rule.range_text(), rule.written().symbol, attempts_of(rule));
    if (takes_plant(key)) {
      value = rule.to_stored(planted_number(), rule.written());
    }
  }
  void numbers(std::string_view key, std::span<double> values, const fields::NumberRule& rule,
               std::string_view text) override {
    double any = 0.0;
    number(key, any, rule, text);
    for (std::size_t i = 0; i < values.size(); ++i) {
      keys_.back().components.push_back(rule.print(values[i]));
      if (takes_plant(std::string(key) + "." + std::to_string(i))) {
        values[i] = rule.to_stored(planted_number(), rule.written());
      }
    }
  }
  void number_list(std::string_view key, std::vector<double>& values,
                   const fields::NumberRule& rule, std::string_view text) override {
    std::vector<double> one{0.0};
    numbers(key, one, rule, text);
    if (has_planted_ && planted_path_ == below(path_, key) + ".0") {
      values = one;
    }
  }
  void whole(std::string_view key, std::int64_t& value, const fields::IntegerRule& rule, bool,
             std::string_view) override {
    add(key, rule.range_text(), rule.unit == nullptr ? "" : rule.unit->symbol,
        attempts_of(rule.lower, rule.upper, "", [](std::int64_t) { return 1; }));
    // Beside an end of the member's own type there is nothing.
    const std::int64_t beside = static_cast<std::int64_t>(planted_number());
    constexpr std::array<std::int64_t, 7> kBesideTypes{-1,    -129,   128,       256,
                                                       65536, -32769, 4294967296};
    if (std::ranges::find(kBesideTypes, beside) == kBesideTypes.end() && takes_plant(key)) {
      value = beside;
    }
  }
  void duration(std::string_view key, std::chrono::nanoseconds& value,
                const fields::DurationRule& rule, std::string_view) override {
    // What is written passes through a double, which has 53 bits.
    const auto step = [](std::int64_t bound) { return 1 + (bound >> 50); };
    add(key, rule.range_text(), "s", attempts_of(rule.lower_ns, rule.upper_ns, " ns", step));
    if (takes_plant(key)) {
      value = std::chrono::nanoseconds{std::stoll(planted_)};
    }
  }
  void rate(std::string_view key, std::chrono::nanoseconds&, const fields::NumberRule& rule,
            std::string_view) override {
    add(key, rule.range_text(), rule.written().symbol, attempts_of(rule));
  }

  void pick(std::string_view key, std::size_t& index, std::span<const fields::Named> names,
            std::string_view) override {
    if (index < names.size()) {
      index = form(key, names.size(), index);
    }
  }
  void part(std::string_view key, const fields::Part& part, std::string_view) override {
    const bool is_skipped =
        path_.empty() && std::find(skipped_.begin(), skipped_.end(), key) != skipped_.end();
    if (!is_skipped) {
      descend(std::string(key), std::string(key), part);
    }
  }
  void elements(std::string_view key, fields::Elements& list, std::string_view) override {
    if (list.size() == 0 && forms_ != nullptr) {
      list.append();
    }
    if (list.size() > 0) {
      const std::string first = std::string(key) + ".0";
      descend(first, first, list.at(0));
    }
  }
  void members(std::string_view key, fields::Members& map, std::string_view noun,
               std::string_view) override {
    if (path_.empty() && std::find(skipped_.begin(), skipped_.end(), key) != skipped_.end()) {
      return;
    }
    std::vector<std::string> names = map.names();
    if (names.empty() && forms_ != nullptr) {
      names.emplace_back(noun);
    }
    if (!names.empty()) {
      const std::string first = std::string(key) + "." + names.front();
      descend(first, first, map.at(names.front()));
    }
  }
  void alternatives(std::string_view key, fields::Alternatives& types, std::string_view) override {
    const std::vector<fields::Named> names = types.names();
    types.choose(form(key, names.size(), types.index()));
    descend("", std::string(names[types.index()].name), types.chosen());
  }

 private:
  [[nodiscard]] bool takes_plant(std::string_view key) {
    const bool takes = !planted_.empty() && planted_path_ == below(path_, key);
    has_planted_ = has_planted_ || takes;
    return takes;
  }
  [[nodiscard]] double planted_number() const {
    const auto quantity = fields::split_quantity(planted_);
    return quantity ? quantity->value : 0.0;
  }
  static std::string below(const std::string& above, std::string_view key) {
    return above.empty() || key.empty() ? above + std::string(key) : above + "." + std::string(key);
  }
  void add(std::string_view key, std::string range, std::string_view unit,
           std::vector<Attempt> attempts) {
    keys_.push_back({below(label_, key),
                     below(path_, key),
                     std::move(range),
                     std::string(unit),
                     {},
                     std::move(attempts)});
  }
  std::size_t form(std::string_view key, std::size_t count, std::size_t chosen) {
    const std::string label = below(label_, key);
    if (forms_ != nullptr) {
      const auto wanted = forms_->find(label);
      chosen = wanted == forms_->end() ? chosen : wanted->second;
    }
    forks_.push_back({label, count, chosen});
    return chosen;
  }
  void descend(const std::string& path, const std::string& label, const fields::Part& part) {
    const std::string path_above = path_;
    const std::string label_above = label_;
    path_ = below(path_, path);
    label_ = below(label_, label);
    part.show(*this);
    path_ = path_above;
    label_ = label_above;
  }

  std::span<const std::string_view> skipped_;
  const Forms* forms_;
  std::string path_;
  std::string label_;
  std::string planted_path_;
  std::string planted_;
  bool has_planted_ = false;
  std::vector<RangedKey> keys_;
  std::vector<Fork> forks_;
};

/// Null when the tree has no such key.
inline const OutlineNode* find_node(const OutlineNode& tree, std::string_view path) {
  const std::size_t dot = path.find('.');
  for (const OutlineNode& child : tree.children) {
    if (child.key == path.substr(0, dot)) {
      return dot == std::string_view::npos ? &child : find_node(child, path.substr(dot + 1));
    }
  }
  return nullptr;
}

/// What a file must write to bring the structure's form about: required keys, choices, lists.
inline OutlineNode least(const OutlineNode& tree) {
  OutlineNode kept = tree;
  kept.children.clear();
  for (const OutlineNode& child : tree.children) {
    if (child.kind == OutlineNode::Kind::section) {
      OutlineNode section = least(child);
      if (!section.children.empty()) {
        kept.children.push_back(std::move(section));
      }
    } else if (child.kind == OutlineNode::Kind::list || child.kind == OutlineNode::Kind::named) {
      if (!child.children.empty()) {
        kept.children.push_back(child);
      }
    } else if (child.required || child.type == "choice" || child.type == "yes or no") {
      kept.children.push_back(child);
    }
  }
  return kept;
}

}  // namespace rigwire::hil
