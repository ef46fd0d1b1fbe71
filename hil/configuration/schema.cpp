#include "hil/configuration/schema.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;
using fields::Named;
using fields::NumberRule;

/// Number syntax that fields::split_quantity accepts.
constexpr std::string_view kNumber = R"([-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?)";
constexpr std::string_view kInclude = "include";

std::string escaped(std::string_view symbol) {
  std::string text;
  for (const char c : symbol) {
    if (c == '(' || c == ')' || c == '.' || c == '/') {
      text += '\\';
    }
    text += c;
  }
  return text;
}

/// A number with or without a unit, as text.
Json quantity(fields::Dimension dimension) {
  std::string units;
  for (const fields::Unit& unit : fields::all_units()) {
    if (unit.dimension == dimension && !unit.symbol.empty()) {
      units += (units.empty() ? "" : "|") + escaped(unit.symbol);
    }
  }
  const std::string unit = units.empty() ? "" : "( *(" + units + "))?";
  return {{"type", "string"}, {"pattern", "^" + std::string(kNumber) + unit + "$"}};
}

Json number_schema(const NumberRule& rule) {
  Json bare{{"type", "number"}};
  if (std::isfinite(rule.lower())) {
    bare[rule.lower_is_open() ? "exclusiveMinimum" : "minimum"] = rule.lower();
  }
  if (std::isfinite(rule.upper())) {
    bare["maximum"] = rule.upper();
  }
  return {{"anyOf", {bare, quantity(rule.written().dimension)}}};
}

Json names_schema(std::span<const Named> names) {
  Json words = Json::array();
  Json numbers = Json::array();
  std::string quantities;
  for (const Named& named : names) {
    words.push_back(named.name);
    // Names that are quantities also match the bare number, and the name without the space.
    if (const auto split = fields::split_quantity(named.name)) {
      numbers.push_back(split->value);
      quantities += (quantities.empty() ? "" : "|") + fields::shortest(split->value) + " *(" +
                    escaped(split->unit) + ")?";
    }
  }
  if (numbers.empty()) {
    return {{"enum", words}};
  }
  return {{"anyOf",
           {{{"enum", words}},
            {{"enum", numbers}},
            {{"type", "string"}, {"pattern", "^(" + quantities + ")$"}}}}};
}

Json include_schema() {
  return {{"description", "Files whose keys come first; the keys written here beat them."},
          {"anyOf", {{{"type", "string"}}, {{"type", "array"}, {"items", {{"type", "string"}}}}}}};
}

/// A choice that is tried in place of the one that the structure holds.
struct Trial {
  std::string_view key;
  std::size_t index;
};

/// A written value that is one of `names`.
Json is_named(std::span<const Named> names, bool is_boolean) {
  return is_boolean ? Json{{"const", names.front().name == "true"}} : names_schema(names);
}

class Writer final : public fields::Visitor {
 public:
  explicit Writer(std::optional<Trial> trial = std::nullopt) : trial_(trial) {}

  /// Schema of an object. Required keys are kept apart, since a file that includes another, here or
  /// further up, need not write them itself.
  struct Object {
    Json schema;
    Json needs;  ///< Required keys; empty: none.
  };

  /// Returns the schema of the keys that `show` names.
  template <class Show>
  static Object object_of(const Show& show) {
    const Keys keys = keys_of(show);
    Object object{{{"type", "object"}, {"properties", Json::object()}}, Json::object()};
    object.schema["properties"][std::string(kInclude)] = include_schema();
    object.schema["properties"].update(keys.properties);
    object.schema["additionalProperties"] = false;
    if (!keys.cases.empty()) {
      object.schema["allOf"] = keys.cases;
    }
    if (!keys.needs.empty()) {
      object.needs = {{"if", {{"required", {kInclude}}}}, {"else", keys.needs}};
    }
    return object;
  }

  void required(std::string_view key) override { required_.push_back(key); }
  void refused(std::string_view, std::string_view) override {}
  void conditional(bool holds, std::string_view choice, std::string_view,
                   const fields::Part& keys) override {
    // What a number or a text decides only the program itself checks.
    const bool is_picked = std::ranges::find(picks_, choice, &Pick::key) != picks_.end();
    if (is_picked) {
      deciders_.insert(choice);
    }
    if (holds || !is_picked) {
      keys.show(*this);
    }
  }
  void check(bool, std::string_view, const std::string&, const std::string&,
             const std::string&) override {}

  void number(std::string_view key, double& value, const NumberRule& rule,
              std::string_view text) override {
    add(key, number_schema(rule), text)["default"] = rule.print(value);
  }
  void numbers(std::string_view key, std::span<double> values, const NumberRule& rule,
               std::string_view text) override {
    add(key,
        {{"type", "array"},
         {"items", number_schema(rule)},
         {"minItems", values.size()},
         {"maxItems", values.size()}},
        text);
  }
  void number_list(std::string_view key, std::vector<double>&, const NumberRule& rule,
                   std::string_view text) override {
    add(key, {{"type", "array"}, {"items", number_schema(rule)}}, text);
  }
  void whole(std::string_view key, std::int64_t& value, const fields::IntegerRule& rule,
             bool unsigned_64, std::string_view text) override {
    Json bare{{"type", "integer"}};
    if (rule.lower != std::numeric_limits<std::int64_t>::min()) {
      bare["minimum"] = rule.lower;
    }
    if (rule.upper != std::numeric_limits<std::int64_t>::max()) {
      bare["maximum"] = rule.upper;
    }
    const Json spelled = rule.unit != nullptr ? quantity(rule.unit->dimension)
                                              : Json{{"type", "string"},
                                                     {"pattern", "^(0[xX][0-9a-fA-F]+|-?\\d+)$"}};
    Json& schema = add(key, {{"anyOf", {bare, spelled}}}, text);
    if (unsigned_64) {
      schema["default"] = static_cast<std::uint64_t>(value);
    } else {
      schema["default"] = value;
    }
  }
  void boolean(std::string_view key, bool& value, std::string_view text) override {
    picks_.push_back({key, value ? 1U : 0U, {{"false", ""}, {"true", ""}}, true});
    if (trial_ && trial_->key == key) {
      value = trial_->index == 1;
    }
    add(key, {{"type", "boolean"}}, text)["default"] = picks_.back().index == 1;
  }
  void text(std::string_view key, std::string& value, std::string_view text) override {
    add(key, {{"type", {"string", "number", "boolean"}}}, text)["default"] = value;
  }
  void texts(std::string_view key, std::vector<std::string>& values,
             std::string_view text) override {
    add(key, {{"type", "array"}, {"items", {{"type", {"string", "number", "boolean"}}}}},
        text)["default"] = values;
  }
  void file(std::string_view key, std::string&, fields::FileKind, std::string_view text) override {
    add(key, {{"type", "string"}}, text);
  }
  void duration(std::string_view key, std::chrono::nanoseconds& value,
                const fields::DurationRule& rule, std::string_view text) override {
    Json bare{{"type", "number"}, {"minimum", static_cast<double>(rule.lower_ns) / 1e9}};
    if (rule.upper_ns != std::numeric_limits<std::int64_t>::max()) {
      bare["maximum"] = static_cast<double>(rule.upper_ns) / 1e9;
    }
    add(key, {{"anyOf", {bare, quantity(fields::Dimension::time)}}}, text)["default"] =
        fields::print_duration(value.count());
  }
  void rate(std::string_view key, std::chrono::nanoseconds&, const NumberRule& rule,
            std::string_view text) override {
    add(key, number_schema(rule), text);
  }
  void spelled(std::string_view key, const fields::Spelling& spelling,
               std::string_view text) override {
    add(key, {{"type", "string"}}, text)["default"] = spelling.print();
  }
  void pick(std::string_view key, std::size_t& index, std::span<const Named> names,
            std::string_view text) override {
    picks_.push_back({key, index, {names.begin(), names.end()}, false});
    if (trial_ && trial_->key == key) {
      index = trial_->index;
    }
    Json& schema = add(key, names_schema(names), with_meanings(text, names));
    if (picks_.back().index < names.size()) {
      schema["default"] = names[picks_.back().index].name;
    }
  }

  void part(std::string_view key, const fields::Part& part, std::string_view text) override {
    const Object object = object_of([&](Visitor& v) { part.show(v); });
    add(key, object.schema, text);
    need(key, object.needs);
  }
  void elements(std::string_view key, fields::Elements& list, std::string_view text) override {
    const fields::Part element = list.append();
    const Object object = object_of([&](Visitor& v) { element.show(v); });
    add(key, {{"type", "array"}, {"items", object.schema}}, text);
    if (!object.needs.empty()) {
      need(key, {{"items", object.needs}});
    }
  }
  void members(std::string_view key, fields::Members& map, std::string_view noun,
               std::string_view text) override {
    constexpr const char* kNames = "^(?!include$)[a-z0-9_-]+$";
    const fields::Part member = map.at(std::string(noun));
    const Object object = object_of([&](Visitor& v) { member.show(v); });
    Json schema{{"type", "object"}};
    schema["properties"][std::string(kInclude)] = include_schema();
    schema["patternProperties"][kNames] = object.schema;
    schema["additionalProperties"] = false;
    add(key, schema, text);
    if (!object.needs.empty()) {
      need(key, {{"patternProperties", {{kNames, object.needs}}}});
    }
  }
  void alternatives(std::string_view key, fields::Alternatives& types,
                    std::string_view text) override {
    const std::vector<Named> names = types.names();
    const std::size_t chosen = types.index();
    add(key, names_schema(names), with_meanings(text, names));
    std::vector<Keys> cases;
    for (std::size_t i = 0; i < names.size(); ++i) {
      types.choose(i);
      cases.push_back(keys_of([&](Visitor& v) { types.chosen().show(v); }));
    }
    const bool must_be_written = std::ranges::find(required_, key) != required_.end();
    add_cases(key, names, false, cases, must_be_written ? fields::kNoChoice : chosen);
    types.choose(chosen);
  }

 private:
  struct Pick {
    std::string_view key;
    std::size_t index;
    std::vector<Named> names;
    bool is_boolean;
  };

  Json& add(std::string_view key, Json schema, std::string_view text) {
    Json& place = properties_[std::string(key)];
    place = Json::object();
    place["description"] = text;
    place.update(schema);
    return place;
  }

  static std::string with_meanings(std::string_view text, std::span<const Named> names) {
    std::string all(text);
    for (const Named& named : names) {
      if (!named.text.empty()) {
        all += "\n" + std::string(named.name) + ": " + std::string(named.text);
      }
    }
    return all;
  }

  /// The keys of a structure before they are put together.
  struct Keys {
    Json properties = Json::object();
    Json cases = Json::array();
    Json needs = Json::object();
  };

  void need(std::string_view key, const Json& needs) {
    if (!needs.empty()) {
      needs_["properties"][std::string(key)] = needs;
    }
  }

  template <class Show>
  static Keys keys_of(const Show& show) {
    Writer writer;
    show(static_cast<Visitor&>(writer));
    for (const Pick& pick : std::vector(writer.picks_)) {
      if (writer.deciders_.contains(pick.key)) {
        try_choices(show, pick, writer);
      }
    }
    for (const std::string_view key : writer.required_) {
      writer.needs_["required"].push_back(key);
    }
    return {writer.properties_, writer.cases_, writer.needs_};
  }

  /// Keys that have no effect with some names of a choice are refused where one of those is
  /// written.
  template <class Show>
  static void try_choices(const Show& show, const Pick& pick, Writer& writer) {
    std::vector<Keys> cases;
    for (std::size_t i = 0; i < pick.names.size(); ++i) {
      Writer trial(Trial{pick.key, i});
      show(static_cast<Visitor&>(trial));
      trial.properties_.erase(std::string(pick.key));
      cases.push_back({.properties = trial.properties_});
    }
    Writer back(Trial{pick.key, pick.index});
    show(static_cast<Visitor&>(back));
    const auto names_of = [](const Keys& one) {
      std::vector<std::string> names;
      for (const auto& [key, schema] : one.properties.items()) {
        names.push_back(key);
      }
      return names;
    };
    // What every case has is no matter of the choice.
    for (const std::string& key : names_of(cases.front())) {
      const bool common =
          std::ranges::all_of(cases, [&](const Keys& one) { return one.properties.contains(key); });
      for (Keys& one : cases) {
        if (common) {
          one.properties.erase(key);
        }
      }
    }
    for (const Keys& one : cases) {
      for (const auto& [key, schema] : one.properties.items()) {
        writer.properties_[key] = schema;
      }
    }
    writer.add_cases(pick.key, pick.names, pick.is_boolean, cases, fields::kNoChoice);
  }

  /// Keys that are there when `key` has the name of their case, or is not written and the case is
  /// the `otherwise`.
  void add_cases(std::string_view key, std::span<const Named> names, bool is_boolean,
                 std::span<const Keys> cases, std::size_t otherwise) {
    Json nobody = Json::object();
    for (const Keys& one : cases) {
      for (const auto& [name, schema] : one.properties.items()) {
        nobody[name] = false;
        if (!properties_.contains(name)) {
          properties_[name] = true;
        }
      }
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
      Json condition{
          {"properties", {{std::string(key), is_named(names.subspan(i, 1), is_boolean)}}},
          {"required", {key}}};
      if (!cases[i].needs.empty()) {
        needs_["allOf"].push_back({{"if", condition}, {"then", cases[i].needs}});
      }
      if (i == otherwise) {
        const Json unwritten{
            {"not", {{"anyOf", {{{"required", {key}}}, {{"required", {kInclude}}}}}}}};
        condition = {{"anyOf", {condition, unwritten}}};
      }
      Json then{{"properties", nobody}};
      then["properties"].update(cases[i].properties);
      if (!cases[i].cases.empty()) {
        then["allOf"] = cases[i].cases;
      }
      cases_.push_back({{"if", condition}, {"then", then}});
    }
  }

  std::optional<Trial> trial_;
  Json properties_ = Json::object();
  Json cases_ = Json::array();
  Json needs_ = Json::object();
  std::vector<std::string_view> required_;
  std::vector<Pick> picks_;
  std::set<std::string_view> deciders_;  ///< Picks that give other keys an effect.
};

}  // namespace

std::string schema_of_part(const fields::Part& part, std::string_view title) {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  const Writer::Object object = Writer::object_of([&](fields::Visitor& v) { part.show(v); });
  schema.update(object.schema);
  schema.update(object.needs);
  return schema.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace rigwire::hil
