// The visitor that turns plain structs into a tree of described fields, and its outputs: the
// effective configuration as YAML, its hash, and the reference of keys.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/problems.h"

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
  std::string value;      ///< YAML text in the field's unit.
  std::string canonical;  ///< Text that enters the hash; for a file its full path.
  std::optional<fields::FileKind> file;
  std::string needs;  ///< Without it the key has no effect: "pumps: engine".
  bool required = false;
  std::vector<OutlineNode> children;
};

/// The tree of a struct. Visit functions take a mutable reference; the struct is not changed.
[[nodiscard]] OutlineNode outline_part(const fields::Part& part);
template <class Struct>
[[nodiscard]] OutlineNode outline(const Struct& value) {
  Struct copy = value;
  return outline_part(fields::Part::of(copy));
}

/// Returns the outline with one element in every list and, below the top, every type that a key can
/// choose: all that is possible, for the reference. The structure is consumed.
[[nodiscard]] OutlineNode reference_outline_part(const fields::Part& part);
template <class Struct>
[[nodiscard]] OutlineNode reference_outline(const Struct& value) {
  Struct copy = value;
  return reference_outline_part(fields::Part::of(copy));
}

/// YAML that loads to the same configuration, each value with a comment saying where it came from
/// ("default", "rigs/pit.yaml:12", "--set ...").
[[nodiscard]] std::string print_yaml(const OutlineNode& tree, const Origins& origins);

/// Returns the text that the hash has for a file and all that it brings in
/// (hil/files/file_content.h).
using FileContent = std::function<std::string(const std::string& path, fields::FileKind kind)>;

/// 64 bits in 16 hexadecimal digits: FNV-1a over the sorted lines "path=value". Independent of the
/// order of keys, of comments, of units as written and of which layer a value came from. Of a file
/// that a value names, its content counts and its place does not.
[[nodiscard]] std::string hash_text(const OutlineNode& tree, const FileContent& content);

/// Reference of the keys, indented text: key, type, unit, range, default, meaning.
[[nodiscard]] std::string reference_text(const OutlineNode& tree);

/// FNV-1a, 64 bit; `basis` continues an earlier hash.
[[nodiscard]] std::uint64_t fnv1a(std::string_view bytes,
                                  std::uint64_t basis = 0xcbf29ce484222325u);

}  // namespace rigwire::hil
