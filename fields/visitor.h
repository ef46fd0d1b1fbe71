// What a structure says of its members, once, for everybody who wants to know: reading from a file,
// printing, hashing, describing, a schema, checking.
//
//   struct Camera { double stroke_m = 0.5; Lens lens; };
//   void visit(fields::Visitor& v, Camera& p) {
//     v.number("stroke", p.stroke_m, in("mm").above(0), "Full travel of the focus.");
//     v.section("lens", p.lens, "In front of the sensor.");
//   }
//   void validate(const Camera& p) {      // optional
//     fields::check(p);                   // every member by its rule (fields/check.h)
//     if (...) throw std::invalid_argument(...);  // only what joins several members
//   }
//
// `visit` and `validate` are free functions in the structure's own namespace, declared under it and
// defined in its source. The member's value at construction is the field's default. A visit
// function may leave out keys by what the device is (`if (model.has_web) v.section(...)`); keys
// that only some values of another key give a meaning it names in only_if(). It must not depend on
// a key that it names only later, and leaves the structure as it was when the visitor changes
// nothing.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "fields/rules.h"
#include "fields/units.h"

namespace rigwire::fields {

class Visitor;

/// A structure with its functions, its type forgotten. Refers to the structure; copied freely.
class Part {
 public:
  template <class Struct>
  [[nodiscard]] static Part of(Struct& value);

  /// Calls visit(v, structure).
  void show(Visitor& v) const { show_(object_, v); }
  /// Calls validate(structure) where there is one. Throws std::invalid_argument.
  void validate() const {
    if (validate_ != nullptr) {
      validate_(object_);
    }
  }
  [[nodiscard]] bool has_validate() const { return validate_ != nullptr; }

 private:
  Part(void* object, void (*show_object)(void*, Visitor&), void (*validate_object)(const void*))
      : object_(object), show_(show_object), validate_(validate_object) {}

  void* object_;
  void (*show_)(void*, Visitor&);
  void (*validate_)(const void*);
};

/// A list of structures.
class Elements {
 public:
  virtual ~Elements() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual Part at(std::size_t index) = 0;
  virtual void clear() = 0;
  /// A further element with its defaults. Parts that were given out before are no longer valid.
  virtual Part append() = 0;
};

/// Structures by name.
class Members {
 public:
  virtual ~Members() = default;
  [[nodiscard]] virtual std::vector<std::string> names() const = 0;
  /// Made with its defaults where there is none of that name.
  virtual Part at(const std::string& name) = 0;
};

/// One structure of several types.
class Alternatives {
 public:
  virtual ~Alternatives() = default;
  [[nodiscard]] virtual std::vector<Named> names() const = 0;
  /// Returns the index of the chosen name in names().
  [[nodiscard]] virtual std::size_t index() const = 0;
  /// Chooses the type at `index`, with its defaults; a type that is chosen already keeps its
  /// values.
  virtual void choose(std::size_t index) = 0;
  virtual Part chosen() = 0;
};

/// A value with a spelling of its own ("2026-06-01T08:00:00Z").
struct Spelling {
  std::string_view type;     ///< What such a value is called: "UTC".
  std::string_view allowed;  ///< What is right, for messages.
  std::function<std::string()> print;
  std::function<void(const std::string&)> parse;  ///< Throws std::invalid_argument.
};

/// Kind of a file, for code that must find every file that it refers to.
enum class FileKind {
  data,       ///< Refers to no other file.
  mesh,       ///< Triangles, with the files of its materials, textures and buffers.
  geoid,      ///< A grid of geoid heights; without a name the one that is installed.
  valve_map,  ///< YAML, which may include other files.
  dbc_node,   ///< YAML binding, which may include other files and names a DBC file.
  memory,     ///< What a device has saved: it need not be there, and a run may write it.
  // The kinds below refer to no other file either; each has its own size limit.
  calibration,  ///< Calibration of a lidar, YAML.
  dbc,          ///< Layouts of CAN frames.
  height_map,   ///< GeoTIFF or PNG.
  motion,       ///< Recorded motion of a machine, MCAP or CSV.
  replay,       ///< Recorded bytes of a wire.
  satellites,   ///< RINEX navigation file or almanac.
  table,        ///< CSV.
};

inline constexpr std::size_t kNoChoice = std::numeric_limits<std::size_t>::max();

/// Keys are unique within a structure. Every function may change the member.
class Visitor {
 public:
  virtual ~Visitor() = default;

  /// The next call is for this key, and a file must write it.
  virtual void required(std::string_view key) = 0;
  /// The key means nothing here, whatever was chosen; `why` says so.
  virtual void refused(std::string_view key, std::string_view why) = 0;
  /// See only_if().
  virtual void conditional(bool holds, std::string_view choice, std::string_view needs,
                           const Part& keys) = 0;
  /// Checks a rule that joins several members: unless it `holds`, `key` is reported as wrong.
  virtual void check(bool holds, std::string_view key, const std::string& what,
                     const std::string& found = {}, const std::string& allowed = {}) = 0;

  /// A finite number with a unit.
  virtual void number(std::string_view key, double& value, const NumberRule& rule,
                      std::string_view text) = 0;
  /// A list of exactly as many numbers as `values` has; `rule` applies to each.
  virtual void numbers(std::string_view key, std::span<double> values, const NumberRule& rule,
                       std::string_view text) = 0;
  /// Any count of numbers.
  virtual void number_list(std::string_view key, std::vector<double>& values,
                           const NumberRule& rule, std::string_view text) = 0;
  /// A whole number. `unsigned_64`: the member is a std::uint64_t, `value` its two's complement,
  /// and without an upper limit its whole range is allowed.
  virtual void whole(std::string_view key, std::int64_t& value, const IntegerRule& rule,
                     bool unsigned_64, std::string_view text) = 0;
  virtual void boolean(std::string_view key, bool& value, std::string_view text) = 0;
  virtual void text(std::string_view key, std::string& value, std::string_view text) = 0;
  /// A list of words.
  virtual void texts(std::string_view key, std::vector<std::string>& values,
                     std::string_view text) = 0;
  /// An existing file, relative to the file that names it; empty: none. The member holds the full
  /// path. Of a memory the path as it is written.
  virtual void file(std::string_view key, std::string& value, FileKind kind,
                    std::string_view text) = 0;
  /// A span of time, exact to the nanosecond.
  virtual void duration(std::string_view key, std::chrono::nanoseconds& value,
                        const DurationRule& rule, std::string_view text) = 0;
  /// A rate in the file, its period in the member (the nearest nanosecond).
  virtual void rate(std::string_view key, std::chrono::nanoseconds& period, const NumberRule& rule,
                    std::string_view text) = 0;
  virtual void spelled(std::string_view key, const Spelling& spelling, std::string_view text) = 0;
  /// One of the names; kNoChoice when the member holds none of them.
  virtual void pick(std::string_view key, std::size_t& index, std::span<const Named> names,
                    std::string_view text) = 0;

  /// A structure under a key of its own.
  virtual void part(std::string_view key, const Part& part, std::string_view text) = 0;
  virtual void elements(std::string_view key, Elements& list, std::string_view text) = 0;
  /// `noun` is what one of them is called in messages ("device").
  virtual void members(std::string_view key, Members& map, std::string_view noun,
                       std::string_view text) = 0;
  /// The key chooses the type; the chosen structure's keys are on the same level.
  virtual void alternatives(std::string_view key, Alternatives& types, std::string_view text) = 0;

  // Templates of the functions above, for members of all types.

  template <std::integral Integer>
  void integer(std::string_view key, Integer& value, const IntegerRule& rule,
               std::string_view text);
  template <class Enumeration, std::size_t kCount>
  void choice(std::string_view key, Enumeration& value,
              const std::array<Choice<Enumeration>, kCount>& choices, std::string_view text);
  /// [x, y] into anything with operator[].
  template <class Vector>
  void vector2(std::string_view key, Vector& value, const NumberRule& rule, std::string_view text);
  /// [x, y, z] into anything with operator[], or with members x, y, z.
  template <class Vector>
  void vector3(std::string_view key, Vector& value, const NumberRule& rule, std::string_view text);
  template <class Struct>
  void section(std::string_view key, Struct& value, std::string_view text) {
    part(key, Part::of(value), text);
  }
  /// Keys under a key of their own that are no structure: `keys(v)` names them.
  template <std::invocable<Visitor&> Keys>
  void group(std::string_view key, Keys keys, std::string_view text);
  /// The keys that `keys(v)` names have an effect only while it `holds`, which the key `choice`
  /// beside them decides; `needs` is what it must be, as a file writes it: "pumps: engine". A file
  /// that writes such a key in vain is refused; one that includes it and chooses otherwise is not.
  template <std::invocable<Visitor&> Keys>
  void only_if(bool holds, std::string_view choice, std::string_view needs, Keys keys);
  template <class Struct>
  void list(std::string_view key, std::vector<Struct>& values, std::string_view text);
  template <class Struct>
  void named(std::string_view key, std::map<std::string, Struct>& values, std::string_view noun,
             std::string_view text);
  /// Each type carries its name: `static constexpr fields::Named kNamed`.
  template <class... Structs>
  void variant(std::string_view key, std::variant<Structs...>& value, std::string_view text);
};

/// The name of the alternative that is chosen.
template <class... Structs>
[[nodiscard]] std::string_view chosen_name(const std::variant<Structs...>& value) {
  return std::visit([](const auto& chosen) { return std::decay_t<decltype(chosen)>::kNamed.name; },
                    value);
}

/// The range of `rule` that an `Integer` can hold.
template <std::integral Integer>
[[nodiscard]] IntegerRule narrowed(IntegerRule rule) {
  if constexpr (sizeof(Integer) < sizeof(std::int64_t) || std::is_signed_v<Integer>) {
    rule.lower = std::max<std::int64_t>(rule.lower, std::numeric_limits<Integer>::min());
    rule.upper = std::min<std::int64_t>(rule.upper, std::numeric_limits<Integer>::max());
  } else {
    rule.lower = std::max<std::int64_t>(rule.lower, 0);
  }
  return rule;
}

// --- templates -----------------------------------------------------------------------------------

namespace detail {

// Outside Part, whose members would hide the functions that are meant.
template <class Struct>
void show(void* object, Visitor& v) {
  visit(v, *static_cast<Struct*>(object));
}
template <class Struct>
void validate_object(const void* object) {
  validate(*static_cast<const Struct*>(object));
}
template <class Struct>
concept Validated = requires(const Struct& value) {
  validate(value);
};

/// Keys that a function names, in place of a structure.
template <class Keys>
struct Group {
  Keys keys;
};
template <class Keys>
void visit(Visitor& v, Group<Keys>& group) {
  group.keys(v);
}

template <class Struct>
class ElementsOf final : public Elements {
 public:
  explicit ElementsOf(std::vector<Struct>& values) : values_(values) {}
  [[nodiscard]] std::size_t size() const override { return values_.size(); }
  [[nodiscard]] Part at(std::size_t index) override { return Part::of(values_[index]); }
  void clear() override { values_.clear(); }
  Part append() override { return Part::of(values_.emplace_back()); }

 private:
  std::vector<Struct>& values_;
};

template <class Struct>
class MembersOf final : public Members {
 public:
  explicit MembersOf(std::map<std::string, Struct>& values) : values_(values) {}
  [[nodiscard]] std::vector<std::string> names() const override {
    std::vector<std::string> names;
    for (const auto& [name, value] : values_) {
      names.push_back(name);
    }
    return names;
  }
  Part at(const std::string& name) override { return Part::of(values_[name]); }

 private:
  std::map<std::string, Struct>& values_;
};

template <class... Structs>
class AlternativesOf final : public Alternatives {
 public:
  explicit AlternativesOf(std::variant<Structs...>& value) : value_(value) {}
  [[nodiscard]] std::vector<Named> names() const override { return {Structs::kNamed...}; }
  [[nodiscard]] std::size_t index() const override { return value_.index(); }
  void choose(std::size_t index) override {
    if (index != value_.index()) {
      std::size_t at = 0;
      ((at++ == index ? static_cast<void>(value_.template emplace<Structs>()) : void()), ...);
    }
  }
  Part chosen() override {
    return std::visit([](auto& chosen) { return Part::of(chosen); }, value_);
  }

 private:
  std::variant<Structs...>& value_;
};

}  // namespace detail

template <class Struct>
Part Part::of(Struct& value) {
  void (*validate_object)(const void*) = nullptr;
  if constexpr (detail::Validated<Struct>) {
    validate_object = &detail::validate_object<Struct>;
  }
  return {&value, &detail::show<Struct>, validate_object};
}

template <std::integral Integer>
void Visitor::integer(std::string_view key, Integer& value, const IntegerRule& rule,
                      std::string_view text) {
  auto whole_number = static_cast<std::int64_t>(value);
  whole(key, whole_number, narrowed<Integer>(rule),
        sizeof(Integer) == sizeof(std::int64_t) && std::is_unsigned_v<Integer>, text);
  value = static_cast<Integer>(whole_number);
}

template <class Enumeration, std::size_t kCount>
void Visitor::choice(std::string_view key, Enumeration& value,
                     const std::array<Choice<Enumeration>, kCount>& choices,
                     std::string_view text) {
  std::array<Named, kCount> names;
  std::size_t index = kNoChoice;
  for (std::size_t i = 0; i < kCount; ++i) {
    names[i] = {choices[i].name, choices[i].text};
    if (index == kNoChoice && choices[i].value == value) {
      index = i;
    }
  }
  pick(key, index, names, text);
  if (index < kCount) {
    value = choices[index].value;
  }
}

template <class Vector>
void Visitor::vector2(std::string_view key, Vector& value, const NumberRule& rule,
                      std::string_view text) {
  std::array<double, 2> components{value[0], value[1]};
  numbers(key, components, rule, text);
  value[0] = components[0];
  value[1] = components[1];
}

template <class Vector>
void Visitor::vector3(std::string_view key, Vector& value, const NumberRule& rule,
                      std::string_view text) {
  if constexpr (requires { value[0]; }) {
    std::array<double, 3> components{value[0], value[1], value[2]};
    numbers(key, components, rule, text);
    for (std::size_t i = 0; i < 3; ++i) {
      value[static_cast<int>(i)] = components[i];
    }
  } else {
    std::array<double, 3> components{value.x, value.y, value.z};
    numbers(key, components, rule, text);
    value.x = components[0];
    value.y = components[1];
    value.z = components[2];
  }
}

template <std::invocable<Visitor&> Keys>
void Visitor::group(std::string_view key, Keys keys, std::string_view text) {
  detail::Group<Keys> group{std::move(keys)};
  part(key, Part::of(group), text);
}

template <std::invocable<Visitor&> Keys>
void Visitor::only_if(bool holds, std::string_view choice, std::string_view needs, Keys keys) {
  detail::Group<Keys> group{std::move(keys)};
  conditional(holds, choice, needs, Part::of(group));
}

template <class Struct>
void Visitor::list(std::string_view key, std::vector<Struct>& values, std::string_view text) {
  detail::ElementsOf<Struct> list(values);
  elements(key, list, text);
}

template <class Struct>
void Visitor::named(std::string_view key, std::map<std::string, Struct>& values,
                    std::string_view noun, std::string_view text) {
  detail::MembersOf<Struct> map(values);
  members(key, map, noun, text);
}

template <class... Structs>
void Visitor::variant(std::string_view key, std::variant<Structs...>& value,
                      std::string_view text) {
  detail::AlternativesOf<Structs...> types(value);
  alternatives(key, types, text);
}

}  // namespace rigwire::fields
