// The visitor that fills plain structs from a document and finds everything that is wrong with it.
//
//   Problems problems;
//   Value document = load_document(file, problems);
//   Origins origins;
//   Camera camera;                       // members hold the defaults
//   read(document, camera, problems, origins);
//   problems.throw_if_any();
//
// It never stops at the first finding: a field that cannot be read keeps its default and reading
// goes on. Keys that no visit function asked for are findings too.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"
#include "sim/samples/calendar.h"
#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

class Reader {
 public:
  /// The document, problems and origins must outlive the reader.
  Reader(const Value& document, Problems& problems, Origins& origins);

  /// The next call with this key finds fault when the key is missing.
  void required(std::string_view key);
  /// Finds fault when the key is there: with what else was chosen it means nothing.
  void refused(std::string_view key, const std::string& why);

  /// A finite number with unit. The range is checked in the written unit.
  void number(std::string_view key, double& value, const NumberRule& rule, std::string_view text);
  /// As many numbers as `values` is long; units and range apply to each.
  void numbers(std::string_view key, std::span<double> values, const NumberRule& rule,
               std::string_view text);
  void number_list(std::string_view key, std::vector<double>& values, const NumberRule& rule,
                   std::string_view text);
  /// A whole number, decimal or 0x hexadecimal.
  template <std::integral Integer>
  void integer(std::string_view key, Integer& value, const IntegerRule& rule,
               std::string_view text);
  /// true or false.
  void boolean(std::string_view key, bool& value, std::string_view text);
  void text(std::string_view key, std::string& value, std::string_view text);
  /// A list of words.
  void texts(std::string_view key, std::vector<std::string>& values, std::string_view text);
  /// A file name, relative to the file that wrote it; must exist unless it is empty. The member
  /// receives the full path.
  void file(std::string_view key, std::string& value, std::string_view text);
  /// A span of time, exact to the nanosecond; a bare number is in seconds.
  void duration(std::string_view key, Duration& value, const DurationRule& rule,
                std::string_view text);
  /// A rate in the file, its period in the member (the nearest nanosecond).
  void rate(std::string_view key, Duration& period, const NumberRule& rule, std::string_view text);
  /// "2026-06-01T08:00:00Z".
  void utc(std::string_view key, UtcTime& value, std::string_view text);
  /// [x, y, z] into a Vector3 or anything with operator[].
  template <class Vector>
  void vector3(std::string_view key, Vector& value, const NumberRule& rule, std::string_view text);
  template <class Enumeration, std::size_t kCount>
  void choice(std::string_view key, Enumeration& value,
              const std::array<Choice<Enumeration>, kCount>& choices, std::string_view text);

  /// A nested struct.
  template <class Struct>
  void section(std::string_view key, Struct& value, std::string_view text);
  /// A list of structs; replaces the default list when given.
  template <class Struct>
  void list(std::string_view key, std::vector<Struct>& values, std::string_view text);
  /// A map from names to structs. `noun` is what one of them is called in messages ("device").
  template <class Struct>
  void named(std::string_view key, std::map<std::string, Struct>& values, std::string_view noun,
             std::string_view text);
  /// The key chooses the alternative, whose own fields stand beside it in the same map.
  template <class... Structs, std::size_t kCount>
  void variant(std::string_view key, std::variant<Structs...>& value,
               const std::array<Alternative, kCount>& alternatives, std::string_view text);

  /// Finds fault with a combination of fields, at the place of `key` in the present section.
  void check(bool holds, std::string_view key, const std::string& what,
             const std::string& found = {}, const std::string& allowed = {});

  /// Reads the whole struct from the map on top.
  template <class Struct>
  void read(Struct& value);

 private:
  struct Frame {
    const Value* map;
    std::string path;
    std::vector<std::string> known;
    bool report_unknown = true;
  };

  [[nodiscard]] std::string path_of(std::string_view key) const;
  const Value* find(std::string_view key);
  const Value* find_scalar(std::string_view key);
  const Value* find_map(std::string_view key);
  const Value* find_list(std::string_view key);
  bool is_scalar(const Value& value, const std::string& path);
  bool read_number(const Value& value, const std::string& path, const NumberRule& rule,
                   double& result);
  /// `unsigned_64`: without an upper limit the whole range of std::uint64_t, in two's complement.
  bool read_integer(const Value& value, const std::string& path, const IntegerRule& rule,
                    bool unsigned_64, std::int64_t& result);
  /// Index of the chosen name, or -1 after reporting.
  int read_choice(const Value& value, const std::string& path,
                  const std::vector<std::string>& names, std::string_view what);
  void push(const Value& map, std::string path);
  void pop();
  void report(const Value& at, const std::string& path, std::string what, std::string found = {},
              std::string allowed = {}, std::string suggestion = {});
  [[nodiscard]] bool keep_entry(const Value::Entry& entry, const std::string& path,
                                const Value& map, std::string_view noun);

  template <class Struct>
  void read_map(const Value& map, const std::string& path, Struct& value);
  template <class Struct>
  void validate_struct(const Value& map, const std::string& path, const Struct& value);
  template <class Variant, std::size_t kIndex = 0>
  void visit_alternative(Variant& value, std::size_t index);

  const Value& document_;
  Problems& problems_;
  Origins& origins_;
  Value nothing_;  ///< An empty map, read in place of a section that nobody wrote.
  std::vector<Frame> frames_;
  std::string required_;
};

/// Reads `value` from the document's top.
template <class Struct>
void read(const Value& document, Struct& value, Problems& problems, Origins& origins) {
  Reader reader(document, problems, origins);
  reader.read(value);
}

// --- templates -----------------------------------------------------------------------------------

template <std::integral Integer>
void Reader::integer(std::string_view key, Integer& value, const IntegerRule& rule,
                     std::string_view) {
  IntegerRule narrowed = rule;
  if constexpr (sizeof(Integer) < sizeof(std::int64_t) || std::is_signed_v<Integer>) {
    narrowed.lower = std::max<std::int64_t>(rule.lower, std::numeric_limits<Integer>::min());
    narrowed.upper = std::min<std::int64_t>(rule.upper, std::numeric_limits<Integer>::max());
  } else {
    narrowed.lower = std::max<std::int64_t>(rule.lower, 0);
  }
  if (const Value* written = find(key)) {
    std::int64_t result = 0;
    constexpr bool kUnsigned64 =
        sizeof(Integer) == sizeof(std::int64_t) && std::is_unsigned_v<Integer>;
    if (read_integer(*written, path_of(key), narrowed, kUnsigned64, result)) {
      value = static_cast<Integer>(result);
    }
  }
}

template <class Vector>
void Reader::vector3(std::string_view key, Vector& value, const NumberRule& rule,
                     std::string_view text) {
  std::array<double, 3> components{};
  if constexpr (std::is_same_v<Vector, Vector3>) {
    components = {value.x, value.y, value.z};
    numbers(key, components, rule, text);
    value = {components[0], components[1], components[2]};
  } else {
    for (int i = 0; i < 3; ++i) {
      components[static_cast<std::size_t>(i)] = value[i];
    }
    numbers(key, components, rule, text);
    for (int i = 0; i < 3; ++i) {
      value[i] = components[static_cast<std::size_t>(i)];
    }
  }
}

template <class Enumeration, std::size_t kCount>
void Reader::choice(std::string_view key, Enumeration& value,
                    const std::array<Choice<Enumeration>, kCount>& choices, std::string_view) {
  if (const Value* written = find(key)) {
    std::vector<std::string> names;
    for (const auto& choice : choices) {
      names.emplace_back(choice.name);
    }
    const int index = read_choice(*written, path_of(key), names, "unknown value");
    if (index >= 0) {
      value = choices[static_cast<std::size_t>(index)].value;
    }
  }
}

template <class Struct>
void Reader::section(std::string_view key, Struct& value, std::string_view) {
  const bool missing = frames_.back().map->find(key) == nullptr;
  const Value* map = find_map(key);
  if (map != nullptr) {
    read_map(*map, path_of(key), value);
  } else if (missing) {
    nothing_.where = frames_.back().map->where;
    read_map(nothing_, path_of(key), value);
  }
}

template <class Struct>
void Reader::list(std::string_view key, std::vector<Struct>& values, std::string_view) {
  const Value* written = find_list(key);
  if (written == nullptr) {
    return;
  }
  values.clear();
  values.reserve(written->items.size());
  for (std::size_t index = 0; index < written->items.size(); ++index) {
    const Value& item = written->items[index];
    const std::string path = path_of(key) + "." + std::to_string(index);
    Struct& value = values.emplace_back();
    if (item.kind != Value::Kind::map) {
      report(item, path, "wrong kind of value", item.description(), "a map of keys");
    } else {
      read_map(item, path, value);
    }
  }
}

template <class Struct>
void Reader::named(std::string_view key, std::map<std::string, Struct>& values,
                   std::string_view noun, std::string_view) {
  const Value* written = find_map(key);
  if (written == nullptr) {
    return;
  }
  for (const Value::Entry& entry : written->entries) {
    const std::string path = path_of(key) + "." + entry.key;
    if (keep_entry(entry, path, *written, noun)) {
      read_map(entry.value, path, values[entry.key]);
    }
  }
}

template <class... Structs, std::size_t kCount>
void Reader::variant(std::string_view key, std::variant<Structs...>& value,
                     const std::array<Alternative, kCount>& alternatives, std::string_view) {
  static_assert(kCount == sizeof...(Structs), "one name for each alternative");
  if (const Value* written = find(key)) {
    std::vector<std::string> names;
    for (const Alternative& alternative : alternatives) {
      names.emplace_back(alternative.name);
    }
    const int index = read_choice(*written, path_of(key), names, "unknown " + std::string(key));
    if (index < 0) {
      frames_.back().report_unknown = false;
      return;
    }
    visit_alternative(value, static_cast<std::size_t>(index));
  } else if (frames_.back().map->find(key) == nullptr) {
    visit_alternative(value, value.index());
    frames_.back().report_unknown = false;
  }
}

template <class Variant, std::size_t kIndex>
void Reader::visit_alternative(Variant& value, std::size_t index) {
  if constexpr (kIndex < std::variant_size_v<Variant>) {
    if (index != kIndex) {
      visit_alternative<Variant, kIndex + 1>(value, index);
      return;
    }
    if (value.index() != kIndex) {
      value.template emplace<kIndex>();
    }
    const std::size_t before = problems_.size();
    visit(*this, std::get<kIndex>(value));
    if (problems_.size() == before) {
      validate_struct(*frames_.back().map, frames_.back().path, std::get<kIndex>(value));
    }
  }
}

template <class Struct>
void Reader::read(Struct& value) {
  if (document_.kind != Value::Kind::map) {
    report(document_, "", "wrong kind of value", document_.description(), "a map of keys");
    return;
  }
  read_map(document_, "", value);
}

template <class Struct>
void Reader::read_map(const Value& map, const std::string& path, Struct& value) {
  const std::size_t before = problems_.size();
  push(map, path);
  visit(*this, value);
  pop();
  if (problems_.size() == before) {
    validate_struct(map, path, value);
  }
}

template <class Struct>
void Reader::validate_struct(const Value& map, const std::string& path, const Struct& value) {
  try {
    if constexpr (requires { value.validate(); }) {
      value.validate();
    } else if constexpr (requires { validate(value); }) {
      validate(value);
    }
  } catch (const std::invalid_argument& error) {
    report(map, path, error.what());
  }
}

}  // namespace rigwire::hil
