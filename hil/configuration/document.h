// A YAML document with the place of every value kept, and the layers of a configuration.
//
// Layers, later ones winning: defaults of the structs < files named by `include:` < the map that
// includes them < --set arguments. Maps merge key by key; lists and scalars are replaced whole.
//
//   machine:
//     include: ../machines/excavator_ref18t.yaml   # or a list of files; relative to this file,
//                                                  # else to a folder of configurations
//     position: [0 m, 0 m, 0 m]                    # overrides what the file says
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "hil/configuration/problems.h"

namespace rigwire::hil {

/// One node. Values are plain and owned; a document is a tree without sharing (aliases are copied).
struct Value {
  enum class Kind { null, scalar, list, map };
  struct Entry;

  Kind kind = Kind::null;
  std::string scalar;
  std::vector<Value> items;
  std::vector<Entry> entries;  ///< In the order written; keys are unique.
  Location where;
  std::string folder;  ///< Folder of the file that wrote it; relative file names start here.

  [[nodiscard]] const Value* find(std::string_view key) const;
  [[nodiscard]] Value* find(std::string_view key);
  /// "a map", "a list", "nothing" or the scalar itself, shortened, for messages.
  [[nodiscard]] std::string description() const;
};

struct Value::Entry {
  std::string key;
  Location where;  ///< Position of the key.
  Value value;
};

/// Limits that keep a hostile or mistaken file from exhausting memory, beside those of its size
/// (hil/configuration/outside_file.h).
inline constexpr std::size_t kMaximumNodes = 1'000'000;  ///< Values, with those of included files.
/// Bytes of keys and values, with those of included files.
inline constexpr std::size_t kMaximumBytes = 64u << 20;
inline constexpr int kMaximumDepth = 64;
inline constexpr std::size_t kMaximumIncludeDepth = 8;
inline constexpr std::size_t kMaximumIncludes = 1000;  ///< Each counted as often as it is read.

/// Limits of a request, so that the cost of applying it is bounded, too (hil/control/desk.h).
inline constexpr std::size_t kMaximumRequestBytes = 64u << 10;  ///< Length of its text.
inline constexpr std::size_t kMaximumRequestNodes = 1024;       ///< Values, lists and maps.
inline constexpr std::size_t kMaximumRequestKeys = 256;         ///< In all of its maps together.
inline constexpr int kMaximumRequestDepth = 16;

/// Reads a file and everything it includes, in a time that grows with their size. Text that is not
/// UTF-8 or has control characters, syntax errors, duplicate keys, keys that are no scalars,
/// missing, circular or too many includes go to `problems`; what could be read is returned.
[[nodiscard]] Value load_document(const std::string& file, Problems& problems);

/// Parses `text` as load_document() does a file; `name` is its name in messages, `folder` the
/// folder to which relative names refer.
[[nodiscard]] Value parse_document(const std::string& text, const std::string& name,
                                   const std::string& folder, Problems& problems);

/// Parses the text of a client that need not be allowed to read this user's files: an `include` in
/// it is a problem, and no file is opened. A text beyond the limits of a request, and one with an
/// anchor or an alias, is a problem before any tree is built.
[[nodiscard]] Value parse_request(const std::string& text, const std::string& name,
                                  Problems& problems);

/// Merges `over` into `base`: maps merge, everything else is replaced.
void overlay(Value& base, Value over);

/// Applies one `--set key.path=value`; the value is YAML ("5", "5 Hz", "[1, 2, 3]"). List elements
/// are addressed by number: "scene.rocks.0.size=1 m". A malformed argument, a path through a
/// scalar, and a map without keys over one that is there go to `problems`; unknown keys are found
/// by the reader, as in a file.
void apply_set(Value& document, const std::string& argument, Problems& problems);

/// Returns what is wrong with a missing file, with the nearest name. Empty when nothing is near.
[[nodiscard]] std::string nearest_file(const std::string& path);

}  // namespace rigwire::hil
