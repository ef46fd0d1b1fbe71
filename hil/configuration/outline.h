// The visitor that turns plain structs into a tree of described fields, and what is made of it:
// the effective configuration as YAML, its hash, and the reference of keys.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"
#include "sim/samples/calendar.h"
#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// One key with its value, or one section, list or map of them.
struct OutlineNode {
  enum class Kind { scalar, flow_list, section, list, named };

  Kind kind = Kind::section;
  std::string key;
  std::string text;       ///< What the key means.
  std::string type;       ///< "number", "text", "device", ...
  std::string unit;       ///< Unit of a bare number; empty without.
  std::string allowed;    ///< Range or names.
  std::string value;      ///< As YAML, in the field's unit.
  std::string canonical;  ///< What enters the hash.
  bool required = false;
  std::vector<OutlineNode> children;
};

class Outliner {
 public:
  Outliner() { stack_.push_back(&root_); }
  Outliner(const Outliner&) = delete;
  Outliner& operator=(const Outliner&) = delete;

  [[nodiscard]] OutlineNode take() && { return std::move(root_); }

  // The same calls as Reader; see there. Nothing is changed.
  void required(std::string_view key) { required_ = key; }
  void refused(std::string_view, const std::string&) {}
  void number(std::string_view key, double value, const NumberRule& rule, std::string_view text);
  void numbers(std::string_view key, std::span<const double> values, const NumberRule& rule,
               std::string_view text);
  void number_list(std::string_view key, const std::vector<double>& values, const NumberRule& rule,
                   std::string_view text);
  template <std::integral Integer>
  void integer(std::string_view key, Integer value, const IntegerRule& rule,
               std::string_view text) {
    whole_number(key, std::to_string(value), rule, text);
  }
  void boolean(std::string_view key, bool value, std::string_view text);
  void text(std::string_view key, const std::string& value, std::string_view text);
  void texts(std::string_view key, const std::vector<std::string>& values, std::string_view text);
  void file(std::string_view key, const std::string& value, std::string_view text);
  void duration(std::string_view key, Duration value, const DurationRule& rule,
                std::string_view text);
  void rate(std::string_view key, Duration period, const NumberRule& rule, std::string_view text);
  void utc(std::string_view key, const UtcTime& value, std::string_view text);
  template <class Vector>
  void vector3(std::string_view key, const Vector& value, const NumberRule& rule,
               std::string_view text);
  template <class Enumeration, std::size_t kCount>
  void choice(std::string_view key, Enumeration value,
              const std::array<Choice<Enumeration>, kCount>& choices, std::string_view text);
  template <class Struct>
  void section(std::string_view key, Struct& value, std::string_view text);
  template <class Struct>
  void list(std::string_view key, std::vector<Struct>& values, std::string_view text);
  template <class Struct>
  void named(std::string_view key, std::map<std::string, Struct>& values, std::string_view noun,
             std::string_view text);
  template <class... Structs, std::size_t kCount>
  void variant(std::string_view key, std::variant<Structs...>& value,
               const std::array<Alternative, kCount>& alternatives, std::string_view text);
  void check(bool, std::string_view, const std::string&, const std::string& = {},
             const std::string& = {}) {}

 private:
  OutlineNode& add(OutlineNode::Kind kind, std::string_view key, std::string_view type,
                   std::string_view text);
  void whole_number(std::string_view key, std::string value, const IntegerRule& rule,
                    std::string_view text);
  void name(std::string_view key, std::string_view type, std::string value, std::string allowed,
            std::string_view text);
  template <class Struct>
  void descend(OutlineNode& node, Struct& value);

  OutlineNode root_;
  std::vector<OutlineNode*> stack_;
  std::string required_;
};

/// The tree of a struct. Visit functions take a mutable reference; the struct is not changed.
template <class Struct>
[[nodiscard]] OutlineNode outline(const Struct& value) {
  Struct copy = value;
  Outliner outliner;
  visit(outliner, copy);
  return std::move(outliner).take();
}

/// YAML that loads to the same configuration, each value with a comment saying where it came from
/// ("default", "rigs/pit.yaml:12", "--set ...").
[[nodiscard]] std::string print_yaml(const OutlineNode& tree, const Origins& origins);

/// 64 bits in 16 hexadecimal digits: FNV-1a over the sorted lines "path=value". Independent of the
/// order of keys, of comments, of units as written and of which layer a value came from. Of a file
/// that a value names, its content counts and its place does not.
[[nodiscard]] std::string hash_text(const OutlineNode& tree);

/// Reference of the keys, indented text: key, type, unit, range, default, meaning.
[[nodiscard]] std::string reference_text(const OutlineNode& tree);

/// FNV-1a, 64 bit; `basis` continues an earlier hash.
[[nodiscard]] std::uint64_t fnv1a(std::string_view bytes,
                                  std::uint64_t basis = 0xcbf29ce484222325u);

// --- templates -----------------------------------------------------------------------------------

template <class Vector>
void Outliner::vector3(std::string_view key, const Vector& value, const NumberRule& rule,
                       std::string_view text) {
  std::array<double, 3> components{};
  if constexpr (std::is_same_v<Vector, Vector3>) {
    components = {value.x, value.y, value.z};
  } else {
    for (int i = 0; i < 3; ++i) {
      components[static_cast<std::size_t>(i)] = value[i];
    }
  }
  numbers(key, components, rule, text);
}

template <class Enumeration, std::size_t kCount>
void Outliner::choice(std::string_view key, Enumeration value,
                      const std::array<Choice<Enumeration>, kCount>& choices,
                      std::string_view text) {
  std::string allowed;
  std::string chosen;
  for (const auto& choice : choices) {
    allowed += (allowed.empty() ? "" : ", ") + std::string(choice.name);
    if (choice.value == value) {
      chosen = choice.name;
    }
  }
  name(key, "choice", std::move(chosen), std::move(allowed), text);
}

template <class Struct>
void Outliner::descend(OutlineNode& node, Struct& value) {
  stack_.push_back(&node);
  visit(*this, value);
  stack_.pop_back();
}

template <class Struct>
void Outliner::section(std::string_view key, Struct& value, std::string_view text) {
  descend(add(OutlineNode::Kind::section, key, "section", text), value);
}

template <class Struct>
void Outliner::list(std::string_view key, std::vector<Struct>& values, std::string_view text) {
  OutlineNode& node = add(OutlineNode::Kind::list, key, "list", text);
  node.children.reserve(values.size());
  for (std::size_t index = 0; index < values.size(); ++index) {
    OutlineNode& child = node.children.emplace_back();
    child.key = std::to_string(index);
    descend(child, values[index]);
  }
}

template <class Struct>
void Outliner::named(std::string_view key, std::map<std::string, Struct>& values,
                     std::string_view noun, std::string_view text) {
  OutlineNode& node = add(OutlineNode::Kind::named, key, noun, text);
  node.children.reserve(values.size());
  for (auto& [child_key, value] : values) {
    OutlineNode& child = node.children.emplace_back();
    child.key = child_key;
    child.type = noun;
    descend(child, value);
  }
}

template <class... Structs, std::size_t kCount>
void Outliner::variant(std::string_view key, std::variant<Structs...>& value,
                       const std::array<Alternative, kCount>& alternatives, std::string_view text) {
  static_assert(kCount == sizeof...(Structs), "one name for each alternative");
  std::string allowed;
  for (const Alternative& alternative : alternatives) {
    allowed += (allowed.empty() ? "" : ", ") + std::string(alternative.name);
  }
  name(key, "choice", std::string(alternatives[value.index()].name), std::move(allowed), text);
  std::visit([this](auto& chosen) { visit(*this, chosen); }, value);
}

}  // namespace rigwire::hil
