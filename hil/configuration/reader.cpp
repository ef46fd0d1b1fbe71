#include "hil/configuration/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

#include "fields/check.h"
#include "fields/constants.h"
#include "fields/units.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

using fields::Dimension;
using fields::DurationRule;
using fields::IntegerRule;
using fields::Named;
using fields::NumberRule;
using fields::Unit;

namespace {

constexpr std::string_view kWrongKind = "wrong kind of value";

bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

std::vector<std::string> words(std::span<const Named> names) {
  std::vector<std::string> words;
  for (const Named& named : names) {
    words.emplace_back(named.name);
  }
  return words;
}

std::string and_range(const std::string& units, const std::string& range) {
  return range.empty() ? units : units + " (" + range + ")";
}

/// What is meant by turns per second where an angular rate is asked for, or the other way round:
/// "20 Hz" is "1200 rpm". Empty for other units.
std::string by_the_turn(const fields::Quantity& quantity, const NumberRule& rule) {
  const auto meant = [&](Dimension written, double factor) -> std::string {
    const Unit* unit = fields::find_unit(quantity.unit, written);
    if (unit == nullptr) {
      return {};
    }
    const double si = quantity.value * unit->numerator / unit->denominator * factor;
    const Unit& wanted = rule.written();
    return fmt::format("{:.6g} {}", si * wanted.denominator / wanted.numerator, wanted.symbol);
  };
  switch (rule.written().dimension) {
    case Dimension::angular_rate:
      return meant(Dimension::frequency, kTurn);
    case Dimension::frequency:
      return meant(Dimension::angular_rate, 1.0 / kTurn);
    default:
      return {};
  }
}

/// Returns the layer of the last source that wrote any part of `tree`.
int last_layer(const Value& tree) {
  int layer = tree.where.layer;
  for (const Value& item : tree.items) {
    layer = std::max(layer, last_layer(item));
  }
  for (const Value::Entry& entry : tree.entries) {
    layer = std::max(layer, last_layer(entry.value));
  }
  return layer;
}

/// The place of the first value in the tree that a --set wrote; null without one.
const Location* first_set(const Value& tree) {
  if (tree.where.is_argument()) {
    return &tree.where;
  }
  for (const Value& item : tree.items) {
    if (const Location* found = first_set(item)) {
      return found;
    }
  }
  for (const Value::Entry& entry : tree.entries) {
    if (const Location* found = first_set(entry.value)) {
      return found;
    }
  }
  return nullptr;
}

}  // namespace

Reader::Reader(const Value& document, Problems& problems, Origins& origins)
    : document_(document), problems_(problems), origins_(origins) {
  nothing_.kind = Value::Kind::map;
}

void Reader::required(std::string_view key) {
  required_ = key;
}

std::string Reader::path_of(std::string_view key) const {
  const std::string& above = frames_.back().path;
  return above.empty() ? std::string(key) : above + "." + std::string(key);
}

void Reader::report(const Value& at, const std::string& path, std::string what, std::string found,
                    std::string allowed, std::string suggestion) {
  problems_.add({at.where, path, std::move(what), std::move(found), std::move(allowed),
                 std::move(suggestion)});
}

void Reader::report_no_map(const Value& at, const std::string& path) {
  // A text may be meant as the name of a file that has the keys.
  const bool names = at.kind == Value::Kind::scalar && !fields::split_quantity(at.scalar);
  report(at, path, std::string(kWrongKind), at.description(),
         names ? "a map of keys, or of `include: FILE` for those of a file" : "a map of keys");
}

void Reader::push(const Value& map, std::string path) {
  origins_.set(path, map.where);
  frames_.push_back({&map, std::move(path), {}});
}

void Reader::pop() {
  const Frame frame = std::move(frames_.back());
  frames_.pop_back();
  if (!frame.report_unknown) {
    return;
  }
  for (const Value::Entry& entry : frame.map->entries) {
    if (std::find(frame.known.begin(), frame.known.end(), entry.key) != frame.known.end()) {
      continue;
    }
    const std::string path = frame.path.empty() ? entry.key : frame.path + "." + entry.key;
    const std::string suggestion =
        problems_.full() ? std::string() : nearest_word(entry.key, frame.known);
    problems_.add({entry.where, path, "unknown key", "",
                   suggestion.empty() ? join_words(frame.known) : "", suggestion});
  }
}

const Value* Reader::find(std::string_view key, std::string_view meaning) {
  const bool is_required = required_ == key;
  required_.clear();
  Frame& frame = frames_.back();
  frame.known.emplace_back(key);
  const Value* value = frame.map->find(key);
  if (without_effect_) {
    refuse_without_effect(key, value);
    return nullptr;
  }
  if (value == nullptr) {
    if (is_required) {
      while (meaning.ends_with('.')) {
        meaning.remove_suffix(1);
      }
      report(*frame.map, path_of(key),
             meaning.empty() ? "missing key" : fmt::format("missing key ({})", meaning));
    }
    return nullptr;
  }
  origins_.set(path_of(key), value->where);
  if (value->kind == Value::Kind::null) {
    report(*value, path_of(key), "the key has no value");
    return nullptr;
  }
  return value;
}

bool Reader::is_scalar(const Value& value, const std::string& path) {
  if (value.kind != Value::Kind::scalar) {
    report(value, path, std::string(kWrongKind), value.description(), "a single value");
  }
  return value.kind == Value::Kind::scalar;
}

const Value* Reader::find_scalar(std::string_view key, std::string_view meaning) {
  const Value* value = find(key, meaning);
  return value != nullptr && is_scalar(*value, path_of(key)) ? value : nullptr;
}

const Value* Reader::find_map(std::string_view key, std::string_view meaning) {
  const Value* value = find(key, meaning);
  if (value != nullptr && value->kind != Value::Kind::map) {
    report_no_map(*value, path_of(key));
    return nullptr;
  }
  return value;
}

const Value* Reader::find_list(std::string_view key, std::string_view meaning) {
  const Value* value = find(key, meaning);
  if (value != nullptr && value->kind != Value::Kind::list) {
    report(*value, path_of(key), std::string(kWrongKind), value->description(), "a list");
    return nullptr;
  }
  return value;
}

bool Reader::read_number(const Value& value, const std::string& path, const NumberRule& rule,
                         double& result) {
  if (!is_scalar(value, path)) {
    return false;
  }
  const Dimension dimension = rule.written().dimension;
  const std::string units = fields::allowed_units(dimension);
  const auto quantity = fields::split_quantity(value.scalar);
  if (!quantity) {
    report(value, path, "not a number", value.description(), and_range(units, rule.range_text()));
    return false;
  }
  if (!std::isfinite(quantity->value)) {
    report(value, path, "not a finite number", value.description(),
           and_range(units, rule.range_text()));
    return false;
  }
  const Unit* unit =
      quantity->unit.empty() ? &rule.written() : fields::find_unit(quantity->unit, dimension);
  if (unit == nullptr) {
    std::vector<std::string> symbols;
    for (const Unit& known : fields::all_units()) {
      if (known.dimension == dimension) {
        symbols.emplace_back(known.symbol);
      }
    }
    const std::string near = nearest_word(quantity->unit, symbols);
    const bool same_length = near.size() == quantity->unit.size();
    std::string meant = same_length && edit_distance(near, quantity->unit) == 0 ? near : "";
    report(value, path, "wrong unit", value.description(), units,
           meant.empty() ? by_the_turn(*quantity, rule) : meant);
    return false;
  }
  const double stored = rule.to_stored(quantity->value, *unit);
  if (!std::isfinite(stored) || !rule.contains(stored)) {
    report(value, path, "out of range", value.description(), rule.range_text());
    return false;
  }
  result = stored == 0.0 ? 0.0 : stored;  // no negative zero
  return true;
}

void Reader::number(std::string_view key, double& value, const NumberRule& rule,
                    std::string_view text) {
  if (const Value* written = find(key, text)) {
    read_number(*written, path_of(key), rule, value);
  }
}

void Reader::numbers(std::string_view key, std::span<double> values, const NumberRule& rule,
                     std::string_view text) {
  const Value* written = find_list(key, text);
  if (written == nullptr) {
    return;
  }
  if (written->items.size() != values.size()) {
    report(*written, path_of(key), "wrong number of elements",
           std::to_string(written->items.size()), std::to_string(values.size()));
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    read_number(written->items[i], path_of(key) + "." + std::to_string(i), rule, values[i]);
  }
}

void Reader::number_list(std::string_view key, std::vector<double>& values, const NumberRule& rule,
                         std::string_view text) {
  const Value* written = frames_.back().map->find(key);
  if (!without_effect_ && written != nullptr && written->kind == Value::Kind::list) {
    values.assign(written->items.size(), 0.0);
  }
  numbers(key, values, rule, text);
}

bool Reader::read_integer(const Value& value, const std::string& path, const IntegerRule& rule,
                          bool unsigned_64, std::int64_t& result) {
  if (!is_scalar(value, path)) {
    return false;
  }
  std::string_view text = value.scalar;
  if (rule.unit != nullptr) {
    const auto quantity = fields::split_quantity(text);
    if (quantity && !quantity->unit.empty()) {
      return read_counted(value, path, rule, result);
    }
  }
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) {
    text.remove_prefix(2);
  }
  std::int64_t number = 0;
  const int base = hexadecimal ? 16 : 10;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  std::uint64_t beyond = 0;
  if (error == std::errc::result_out_of_range && unsigned_64 &&
      rule.upper == std::numeric_limits<std::int64_t>::max() &&
      std::from_chars(text.data(), text.data() + text.size(), beyond, base).ec == std::errc{}) {
    result = static_cast<std::int64_t>(beyond);
    return true;
  }
  if (error == std::errc::invalid_argument || end != text.data() + text.size()) {
    report(value, path, "not a whole number", value.description(), rule.range_text());
    return false;
  }
  if (error != std::errc{} || !rule.contains(number)) {
    report(value, path, "out of range", value.description(), rule.range_text());
    return false;
  }
  result = number;
  return true;
}

bool Reader::read_counted(const Value& value, const std::string& path, const IntegerRule& rule,
                          std::int64_t& result) {
  const NumberRule number = NumberRule(*rule.unit, *rule.unit);
  double counted = 0.0;
  if (!read_number(value, path, number, counted)) {
    return false;
  }
  // A decimal fraction of a larger unit ("0.003 s") is whole but for rounding.
  const double whole = std::round(counted);
  if (std::fabs(counted - whole) > 1e-9 * std::max(1.0, std::fabs(whole))) {
    report(value, path, "not a whole number of " + std::string(rule.unit->symbol),
           value.description(), rule.range_text());
    return false;
  }
  constexpr double kLimit = 9.2e18;  // 2^63 as a double; beyond it there is no int64
  if (std::fabs(whole) > kLimit || !rule.contains(static_cast<std::int64_t>(whole))) {
    report(value, path, "out of range", value.description(), rule.range_text());
    return false;
  }
  result = static_cast<std::int64_t>(whole);
  return true;
}

void Reader::whole(std::string_view key, std::int64_t& value, const IntegerRule& rule,
                   bool unsigned_64, std::string_view text) {
  if (const Value* written = find(key, text)) {
    read_integer(*written, path_of(key), rule, unsigned_64, value);
  }
}

void Reader::boolean(std::string_view key, bool& value, std::string_view text) {
  const Value* written = find_scalar(key, text);
  if (written == nullptr) {
    return;
  }
  if (written->scalar == "true" || written->scalar == "false") {
    value = written->scalar == "true";
    return;
  }
  report(*written, path_of(key), "not a yes-or-no value", written->description(), "true, false");
}

void Reader::text(std::string_view key, std::string& value, std::string_view text) {
  const Value* written = find_scalar(key, text);
  if (written != nullptr && is_one_line(*written, path_of(key))) {
    value = written->scalar;
  }
}

bool Reader::is_one_line(const Value& value, const std::string& path) {
  const auto fault = find_fault(value.scalar, TextShape::one_line);
  if (fault) {
    report(value, path, fault->what, fault->found, "text of one line");
  }
  return !fault;
}

void Reader::texts(std::string_view key, std::vector<std::string>& values, std::string_view text) {
  const Value* written = find_list(key, text);
  if (written == nullptr) {
    return;
  }
  values.clear();
  for (std::size_t i = 0; i < written->items.size(); ++i) {
    const Value& item = written->items[i];
    const std::string path = path_of(key) + "." + std::to_string(i);
    origins_.set(path, item.where);
    if (is_scalar(item, path) && is_one_line(item, path)) {
      values.push_back(item.scalar);
    }
  }
}

void Reader::file(std::string_view key, std::string& value, fields::FileKind kind,
                  std::string_view text) {
  const Value* written = find_scalar(key, text);
  if (written == nullptr || !is_one_line(*written, path_of(key))) {
    return;
  }
  if (written->scalar.empty()) {
    value.clear();
    return;
  }
  const bool is_memory = kind == fields::FileKind::memory;
  const fs::path full = is_memory
                            ? fs::path(written->scalar)
                            : (fs::path(written->folder) / written->scalar).lexically_normal();
  try {
    // The reader of its content opens it again; what is refused here has the key's place.
    const OutsideFile opened(full, limit_of(kind));
    value = is_memory ? written->scalar : resolved_path(full);
  } catch (const FileRefused& refused) {
    if (is_memory && refused.error() == ENOENT) {
      value = written->scalar;
    } else if (refused.missing()) {
      report(*written, path_of(key),
             fmt::format("no such file {}, tried {}", written->description(), full.string()), "",
             "", nearest_file(full.string()));
    } else {
      report(*written, path_of(key), refused.path_and_reason(), refused.found(), refused.allowed());
    }
  }
}

void Reader::duration(std::string_view key, std::chrono::nanoseconds& value,
                      const DurationRule& rule, std::string_view text) {
  const Value* written = find(key, text);
  double nanoseconds = 0.0;
  const std::string path = path_of(key);
  if (written == nullptr ||
      !read_number(*written, path, fields::in("s").stored_as("ns"), nanoseconds)) {
    return;
  }
  // 2^63 as a double; beyond it the count has no int64.
  constexpr double kLimit = 9.2e18;
  const bool fits = std::fabs(nanoseconds) < kLimit;
  const std::int64_t count = fits ? std::llround(nanoseconds) : 0;
  if (!fits || count < rule.lower_ns || count > rule.upper_ns) {
    report(*written, path, "out of range", written->description(), rule.range_text());
    return;
  }
  value = std::chrono::nanoseconds{count};
}

void Reader::rate(std::string_view key, std::chrono::nanoseconds& period, const NumberRule& rule,
                  std::string_view text) {
  const Value* written = find(key, text);
  double hertz = 0.0;
  if (written != nullptr && read_number(*written, path_of(key), rule, hertz) && hertz > 0.0) {
    period = from_seconds(1.0 / hertz);
  }
}

void Reader::spelled(std::string_view key, const fields::Spelling& spelling,
                     std::string_view text) {
  const Value* written = find_scalar(key, text);
  if (written == nullptr) {
    return;
  }
  try {
    spelling.parse(written->scalar);
  } catch (const std::invalid_argument& error) {
    report(*written, path_of(key), error.what(), written->description(),
           std::string(spelling.allowed));
  }
}

std::size_t Reader::read_choice(const Value& value, const std::string& path,
                                std::span<const Named> names, std::string_view what) {
  if (!is_scalar(value, path)) {
    return fields::kNoChoice;
  }
  const auto it = std::ranges::find(names, std::string_view(value.scalar), &Named::name);
  if (it != names.end()) {
    return static_cast<std::size_t>(it - names.begin());
  }
  if (const auto quantity = fields::split_quantity(value.scalar)) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto named = fields::split_quantity(names[i].name);
      if (named && named->value == quantity->value &&
          (quantity->unit.empty() || quantity->unit == named->unit)) {
        return i;
      }
    }
  }
  const std::vector<std::string> allowed = words(names);
  report(value, path, std::string(what), value.description(), join_words(allowed),
         nearest_word(value.scalar, allowed));
  return fields::kNoChoice;
}

void Reader::pick(std::string_view key, std::size_t& index, std::span<const Named> names,
                  std::string_view text) {
  if (const Value* written = find(key, text)) {
    const std::size_t chosen = read_choice(*written, path_of(key), names, "unknown value");
    if (chosen != fields::kNoChoice) {
      index = chosen;
    }
  }
}

void Reader::part(std::string_view key, const fields::Part& part, std::string_view) {
  const bool missing = frames_.back().map->find(key) == nullptr;
  const Value* map = find_map(key);
  if (map != nullptr) {
    read_map(*map, path_of(key), part);
  } else if (missing && !without_effect_) {
    nothing_.where = frames_.back().map->where;
    read_map(nothing_, path_of(key), part);
  }
}

void Reader::elements(std::string_view key, fields::Elements& list, std::string_view text) {
  const Value* written = find_list(key, text);
  if (written == nullptr) {
    return;
  }
  list.clear();
  for (std::size_t index = 0; index < written->items.size(); ++index) {
    const Value& item = written->items[index];
    const std::string path = path_of(key) + "." + std::to_string(index);
    const fields::Part part = list.append();
    if (item.kind != Value::Kind::map) {
      report_no_map(item, path);
    } else {
      read_map(item, path, part);
    }
  }
}

void Reader::members(std::string_view key, fields::Members& map, std::string_view noun,
                     std::string_view) {
  const Value* written = find_map(key);
  if (written == nullptr) {
    return;
  }
  for (const Value::Entry& entry : written->entries) {
    const std::string path = path_of(key) + "." + entry.key;
    if (keep_entry(entry, path, *written, noun)) {
      read_map(entry.value, path, map.at(entry.key));
    }
  }
}

void Reader::alternatives(std::string_view key, fields::Alternatives& types, std::string_view) {
  const bool missing = frames_.back().map->find(key) == nullptr;
  const Value* written = find(key, missing ? join_words(words(types.names())) : std::string());
  if (written != nullptr) {
    const std::size_t index =
        read_choice(*written, path_of(key), types.names(), "unknown " + std::string(key));
    if (index == fields::kNoChoice) {
      frames_.back().report_unknown = false;
      return;
    }
    types.choose(index);
  } else if (!missing || without_effect_) {
    return;  // a key without a value or without effect, already reported
  }
  const fields::Part chosen = types.chosen();
  const std::size_t before = problems_.size();
  chosen.show(*this);
  if (problems_.size() == before) {
    validate(*frames_.back().map, frames_.back().path, chosen);
  }
  if (missing) {
    frames_.back().report_unknown = false;  // the keys of another type may be meant
  }
}

void Reader::read(const fields::Part& part) {
  if (document_.kind != Value::Kind::map) {
    report_no_map(document_, "");
    return;
  }
  read_map(document_, "", part);
}

void Reader::read_map(const Value& map, const std::string& path, const fields::Part& part) {
  const std::size_t before = problems_.size();
  push(map, path);
  part.show(*this);
  pop();
  if (problems_.size() == before) {
    validate(map, path, part);
  }
}

void Reader::validate(const Value& map, const std::string& path, const fields::Part& part) {
  // When members contradict each other, blame the one that --set changed: without it the files may
  // be sound. Otherwise blame the named one.
  const auto blame = [&](const std::string& at, std::string what) {
    const Location named = origins_.nearest(at);
    const Location* argument = first_set(map);
    if (argument != nullptr && !named.is_argument() && !named.is_default()) {
      what += ", together with " + named.line_text();
    }
    problems_.add({argument != nullptr ? *argument : named, at, std::move(what), {}, {}, {}});
  };
  try {
    part.validate();
  } catch (const fields::Refused& refused) {
    const bool both = !path.empty() && !refused.path().empty();
    blame(path + (both ? "." : "") + refused.path(), refused.rest());
  } catch (const std::invalid_argument& error) {
    blame(path, error.what());
  }
}

bool Reader::keep_entry(const Value::Entry& entry, const std::string& path, const Value& map,
                        std::string_view noun) {
  if (!is_name(entry.key)) {
    problems_.add({entry.where, path, "not a name", "\"" + entry.key + "\"",
                   "lower-case letters, digits, _ and -", ""});
    return false;
  }
  if (entry.value.kind != Value::Kind::map) {
    report_no_map(entry.value, path);
    return false;
  }
  // A --set that names something the files do not have is a slip, not a new thing.
  if (!entry.where.is_default() && entry.where.line == 0 && entry.value.find("type") == nullptr) {
    std::vector<std::string> names;
    for (const Value::Entry& other : map.entries) {
      if (other.where.line != 0) {
        names.push_back(other.key);
      }
    }
    problems_.add({entry.where, path, fmt::format("no such {}", noun), "\"" + entry.key + "\"",
                   join_words(names), nearest_word(entry.key, names)});
    return false;
  }
  return true;
}

void Reader::refused(std::string_view key, std::string_view why) {
  Frame& frame = frames_.back();
  if (const Value* value = frame.map->find(key)) {
    frame.known.emplace_back(key);
    report(*value, path_of(key), std::string(why));
  }
}

void Reader::conditional(bool holds, std::string_view choice, std::string_view needs,
                         const fields::Part& keys) {
  if (holds) {
    keys.show(*this);
    return;
  }
  const auto before = std::exchange(without_effect_, Condition{choice, needs});
  keys.show(*this);
  without_effect_ = before;
}

void Reader::refuse_without_effect(std::string_view key, const Value* value) {
  const Value* choice = frames_.back().map->find(without_effect_->choice);
  if (value == nullptr || (choice != nullptr && choice->where.layer > last_layer(*value))) {
    return;
  }
  std::string with;
  if (choice != nullptr && choice->kind == Value::Kind::scalar) {
    with = fmt::format(" with {}: {}", without_effect_->choice,
                       choice->scalar.empty() ? "\"\"" : choice->scalar);
  }
  report(*value, path_of(key),
         fmt::format("has no effect{}; it needs {}", with, without_effect_->needs));
}

void Reader::check(bool holds, std::string_view key, const std::string& what,
                   const std::string& found, const std::string& allowed) {
  if (holds || without_effect_) {
    return;
  }
  const Value* value = frames_.back().map->find(key);
  report(value != nullptr ? *value : *frames_.back().map, path_of(key), what, found, allowed);
}

fields::Spelling utc_spelling(UtcTime& time) {
  return {.type = "UTC",
          .allowed = "UTC like 2026-06-01T08:00:00Z",
          .print = [&time] { return format_utc(time); },
          .parse =
              [&time](const std::string& text) {
                const UtcTime parsed = parse_utc(text);
                static_cast<void>(Calendar(parsed));  // throws beyond what it can count
                time = parsed;
              }};
}

}  // namespace rigwire::hil
