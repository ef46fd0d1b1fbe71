#include "hil/configuration/document.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <unordered_map>

#include "hil/configuration/config_folders.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

namespace {

/// Returns whether `byte` begins a character of UTF-8, so is no continuation byte.
bool is_start(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

}  // namespace

const Value* Value::find(std::string_view key) const {
  const auto it = std::find_if(entries.begin(), entries.end(),
                               [&](const Entry& entry) { return entry.key == key; });
  return it == entries.end() ? nullptr : &it->value;
}

Value* Value::find(std::string_view key) {
  return const_cast<Value*>(static_cast<const Value&>(*this).find(key));
}

std::string Value::description() const {
  switch (kind) {
    case Kind::null:
      return "nothing";
    case Kind::list:
      return "a list";
    case Kind::map:
      return "a map";
    case Kind::scalar:
      break;
  }
  constexpr std::size_t kLongest = 60;
  if (scalar.size() <= kLongest) {
    return "\"" + scalar + "\"";
  }
  std::size_t length = kLongest;
  while (length > 0 && !is_start(scalar[length])) {
    --length;
  }
  return "\"" + scalar.substr(0, length) + "...\"";
}

namespace {

/// Records where documents begin.
class DocumentMarks final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { mark_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { at(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { at(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {
    at(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {
    at(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    at(mark);
  }
  void OnMapEnd() override {}

  /// Returns the position of the last document's first node.
  [[nodiscard]] const YAML::Mark& mark() const { return mark_; }
  void next() { open_ = true; }

 private:
  void at(const YAML::Mark& mark) {
    mark_ = open_ ? mark : mark_;
    open_ = false;
  }

  YAML::Mark mark_;
  bool open_ = false;
};

/// Where a second document begins, if there is one. YAML::LoadAll() does not return from some texts
/// that are none (yaml-cpp 0.7: a comma at the beginning), as their documents never end.
std::optional<YAML::Mark> second_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentMarks marks;
  if (!parser.HandleNextDocument(marks)) {
    return std::nullopt;
  }
  marks.next();
  return parser.HandleNextDocument(marks) ? std::optional(marks.mark()) : std::nullopt;
}

/// Why a text is no request.
struct RequestFault {
  YAML::Mark mark;
  std::string what;
  std::string found;
  std::string allowed;
};

/// Receives the events of a request's text, of which nothing is kept, and throws RequestFault at
/// the first that is beyond the bounds of a request.
class RequestBounds final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(mark, anchor); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { refuse_alias(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& /*value*/) override {
    add(mark, anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    add(mark, anchor);
    enter(mark, false);
  }
  void OnSequenceEnd() override { leave(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    add(mark, anchor);
    enter(mark, true);
  }
  void OnMapEnd() override { leave(); }

 private:
  /// A list or a map that is open.
  struct Level {
    bool is_map = false;
    bool key_is_next = false;  ///< In a map: the next scalar is a key.
  };

  [[noreturn]] static void refuse_alias(const YAML::Mark& mark) {
    throw RequestFault{mark, "an anchor or an alias in a request", "& or *",
                       "values that are written out"};
  }
  [[noreturn]] static void refuse_size(const YAML::Mark& mark, const char* what,
                                       std::size_t allowed) {
    throw RequestFault{mark, fmt::format("the request has too many {}", what),
                       fmt::format("more than {}", allowed), fmt::format("at most {}", allowed)};
  }

  void add(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) {
      refuse_alias(mark);
    }
    if (!levels_.empty() && levels_.back().is_map) {
      Level& map = levels_.back();
      map.key_is_next = !map.key_is_next;
      if (!map.key_is_next && ++keys_ > kMaximumRequestKeys) {
        refuse_size(mark, "keys", kMaximumRequestKeys);
      }
    }
    if (++nodes_ > kMaximumRequestNodes + keys_) {
      refuse_size(mark, "values", kMaximumRequestNodes);
    }
  }
  void enter(const YAML::Mark& mark, bool is_map) {
    if (levels_.size() >= static_cast<std::size_t>(kMaximumRequestDepth)) {
      refuse_size(mark, "levels", kMaximumRequestDepth);
    }
    levels_.push_back({is_map, is_map});
  }
  void leave() { levels_.pop_back(); }

  std::vector<Level> levels_;
  std::size_t nodes_ = 0;  ///< With keys.
  std::size_t keys_ = 0;
};

/// Returns why the text is no request; nothing when it is within the bounds, or not YAML, which who
/// parses it reports.
std::optional<RequestFault> request_fault(const std::string& text) {
  if (text.size() > kMaximumRequestBytes) {
    return RequestFault{YAML::Mark::null_mark(), "the request is too long",
                        fmt::format("{} bytes", text.size()),
                        fmt::format("at most {} bytes", kMaximumRequestBytes)};
  }
  if (find_fault(text, TextShape::lines)) {
    return std::nullopt;
  }
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    RequestBounds bounds;
    parser.HandleNextDocument(bounds);
  } catch (const RequestFault& fault) {
    return fault;
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
  return std::nullopt;
}

/// Size of a file and all that it includes; each alias counts as what it refers to.
struct Extent {
  std::size_t max_nodes = kMaximumNodes;
  std::size_t max_bytes = kMaximumBytes;
  std::size_t nodes = 0;
  std::size_t bytes = 0;  ///< Bytes of keys and values.
  std::size_t includes = 0;
  int files = 0;  ///< Read to their end.
  bool may_include = true;
  bool too_big = false;
};

/// Sets the layer of values that have none. An including file overrides the included one, and is
/// finished later: the values of the file itself get the next layer.
void settle_layer(Value& tree, int layer) {
  if (tree.where.layer == 0) {
    tree.where.layer = layer;
  }
  for (Value& item : tree.items) {
    settle_layer(item, layer);
  }
  for (Value::Entry& entry : tree.entries) {
    settle_layer(entry.value, layer);
  }
}

struct Parser {
  std::shared_ptr<const std::string> source;
  std::string folder;
  Problems& problems;
  std::vector<std::string> including;  // canonical files on the way here
  Extent& extent;

  [[nodiscard]] Location at(const YAML::Mark& mark) const {
    return mark.is_null() ? Location{source, 0, 0}
                          : Location{source, mark.line + 1, mark.column + 1};
  }

  void report(const Location& where, const std::string& path, const std::string& what,
              const std::string& found = {}, const std::string& allowed = {}) {
    problems.add({where, path, what, found, allowed, {}});
  }

  Value convert(const YAML::Node& node, const std::string& path, int depth);
  Value convert_map(const YAML::Node& node, const std::string& path, int depth);
  void include(Value& map, const std::string& path);
  [[nodiscard]] std::vector<fs::path> places_of(const std::string& file) const;
  /// Opens the first of the places that is there. False after reporting that none is, or that it is
  /// refused.
  bool open_include(const Value& file, const std::string& key, std::optional<OutsideFile>& opened);
  /// False after reporting: an include too many, too deep, or of itself.
  bool may_include(const Value& file, const std::string& canonical, const std::string& key);
  /// Escapes in quotes can spell what the file itself must not hold.
  void check_text(const std::string& text, const Location& where, const std::string& path);
};

std::string child(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

/// Reads the document that is open and all that it includes. Throws FileRefused where its bytes
/// cannot be read.
Value load_opened(OutsideFile& file, Problems& problems, std::vector<std::string> including,
                  Extent& extent);

/// Line and column, from 1, of a byte of the text; columns count characters.
Location place_of(std::string_view text, std::size_t offset,
                  const std::shared_ptr<const std::string>& source) {
  const std::string_view before = text.substr(0, offset);
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return {source, 1 + static_cast<int>(std::ranges::count(before, '\n')),
          1 + static_cast<int>(std::ranges::count_if(before.substr(line_start), is_start))};
}

Value parse_text(const std::string& text, const std::string& name, const std::string& folder,
                 Problems& problems, std::vector<std::string> including, Extent& extent) {
  Parser parser{std::make_shared<const std::string>(name), folder, problems, std::move(including),
                extent};
  Value result;
  if (const auto fault = find_fault(text, TextShape::lines)) {
    parser.report(place_of(text, fault->offset, parser.source), "", fault->what, fault->found,
                  "UTF-8 without control characters");
    result.kind = Value::Kind::map;
    result.where = Location{parser.source, 1, 1};
    return result;
  }
  try {
    if (const auto second = second_document(text)) {
      parser.report(parser.at(*second), "", "more than one document in the file");
    }
    result = parser.convert(YAML::Load(text), "", 0);
  } catch (const YAML::Exception& error) {
    parser.report(parser.at(error.mark), "", "not valid YAML: " + error.msg);
  }
  if (result.kind == Value::Kind::null) {
    result.kind = Value::Kind::map;  // an empty file says nothing, and that is allowed
  }
  if (result.where.is_default()) {
    result.where = Location{parser.source, 1, 1};
    result.folder = folder;
  }
  settle_layer(result, ++extent.files);
  return result;
}

Value Parser::convert(const YAML::Node& node, const std::string& path, int depth) {
  Value value;
  value.where = at(node.Mark());
  value.folder = folder;
  // An alias is converted as often as it is used, so that its size counts each time.
  if (++extent.nodes > extent.max_nodes || extent.bytes > extent.max_bytes ||
      depth > kMaximumDepth) {
    if (!extent.too_big) {
      report(value.where, path,
             fmt::format("nested deeper than {} levels, or more than {} values or {} bytes",
                         kMaximumDepth, extent.max_nodes, extent.max_bytes));
    }
    extent.too_big = true;
    return value;
  }
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      value.kind = Value::Kind::scalar;
      value.scalar = node.Scalar();
      extent.bytes += value.scalar.size();
      check_text(value.scalar, value.where, path);
      break;
    case YAML::NodeType::Sequence: {
      value.kind = Value::Kind::list;
      std::size_t index = 0;
      for (const YAML::Node& item : node) {
        if (extent.too_big) {
          break;
        }
        value.items.push_back(convert(item, child(path, std::to_string(index++)), depth + 1));
      }
      break;
    }
    case YAML::NodeType::Map: {
      Value map = convert_map(node, path, depth);
      map.where = value.where;
      return map;
    }
    case YAML::NodeType::Null:
    case YAML::NodeType::Undefined:
      break;
  }
  return value;
}

Value Parser::convert_map(const YAML::Node& node, const std::string& path, int depth) {
  Value map;
  map.kind = Value::Kind::map;
  map.folder = folder;
  std::unordered_map<std::string, int> lines;  // Line of each key.
  for (const auto& pair : node) {
    if (extent.too_big) {
      break;
    }
    const Location where = at(pair.first.Mark());
    if (!pair.first.IsScalar()) {
      report(where, path, "a key must be a word", pair.first.IsMap() ? "a map" : "a list");
      continue;
    }
    const std::string key = pair.first.Scalar();
    extent.bytes += key.size();
    check_text(key, where, path);
    const auto [same, fresh] = lines.emplace(key, where.line);
    if (!fresh) {
      report(where, child(path, key),
             fmt::format("the key is given twice, first in line {}", same->second));
      continue;
    }
    map.entries.push_back({key, where, convert(pair.second, child(path, key), depth + 1)});
  }
  include(map, path);
  return map;
}

void Parser::check_text(const std::string& text, const Location& where, const std::string& path) {
  if (const auto fault = find_fault(text, TextShape::lines)) {
    report(where, path, fault->what, fault->found, "UTF-8 without control characters");
  }
}

bool Parser::may_include(const Value& file, const std::string& canonical, const std::string& key) {
  if (std::find(including.begin(), including.end(), canonical) != including.end()) {
    report(file.where, key, "the file includes itself, directly or through others",
           file.description());
    return false;
  }
  if (including.size() > kMaximumIncludeDepth) {
    report(file.where, key, "includes are nested too deeply", file.description(),
           fmt::format("{} files below one another", kMaximumIncludeDepth));
    return false;
  }
  if (++extent.includes > kMaximumIncludes) {
    if (!extent.too_big) {
      report(file.where, key, "too many includes", file.description(),
             fmt::format("{} in all", kMaximumIncludes));
    }
    extent.too_big = true;
    return false;
  }
  return true;
}

/// Relative to the file that includes it, else in the folders of configurations.
std::vector<fs::path> Parser::places_of(const std::string& file) const {
  std::vector<fs::path> places{(fs::path(folder) / file).lexically_normal()};
  if (fs::path(file).is_relative()) {
    for (const fs::path& configs : config_folders()) {
      places.push_back((configs / file).lexically_normal());
      // A copy of a rig that is there says "../scenes/open_pit.yaml".
      places.push_back((configs / "rigs" / file).lexically_normal());
    }
  }
  return places;
}

bool Parser::open_include(const Value& file, const std::string& key,
                          std::optional<OutsideFile>& opened) {
  if (const auto fault = find_fault(file.scalar, TextShape::one_line)) {
    report(file.where, key, "the file's name has " + fault->found + ", which is " + fault->what);
    return false;
  }
  const std::vector<fs::path> tried = places_of(file.scalar);
  std::vector<std::string> names;
  for (const fs::path& place : tried) {
    try {
      opened.emplace(place, kConfigurationFile);
      return true;
    } catch (const FileRefused& refused) {
      if (!refused.missing()) {
        report(file.where, key, refused.path_and_reason(), refused.found(), refused.allowed());
        return false;
      }
    }
    names.push_back(place.string());
  }
  problems.add({file.where, key,
                fmt::format("no such file {}, tried {}", file.description(), join_words(names)), "",
                "", nearest_file(tried.front().string())});
  return false;
}

void Parser::include(Value& map, const std::string& path) {
  const auto it = std::find_if(map.entries.begin(), map.entries.end(),
                               [](const Value::Entry& entry) { return entry.key == "include"; });
  if (it == map.entries.end()) {
    return;
  }
  const Value named = std::move(it->value);
  map.entries.erase(it);
  if (!extent.may_include) {
    report(named.where, child(path, "include"), "a request includes no files", named.description(),
           "what it has itself");
    return;
  }
  std::vector<const Value*> files;
  if (named.kind == Value::Kind::scalar) {
    files.push_back(&named);
  } else if (named.kind == Value::Kind::list) {
    for (const Value& item : named.items) {
      files.push_back(&item);
    }
  } else {
    report(named.where, child(path, "include"), "wrong kind of value", named.description(),
           "a file name or a list of file names");
  }
  Value base;
  base.kind = Value::Kind::map;
  for (const Value* file : files) {
    if (extent.too_big) {
      break;
    }
    const std::string key = child(path, "include");
    if (file->kind != Value::Kind::scalar) {
      report(file->where, key, "wrong kind of value", file->description(), "a file name");
      continue;
    }
    std::optional<OutsideFile> opened;
    if (!open_include(*file, key, opened) ||
        !may_include(*file, resolved_path(opened->path()), key)) {
      continue;
    }
    try {
      // Later files override earlier ones; the map that includes them overrides all.
      overlay(base, load_opened(*opened, problems, including, extent));
    } catch (const FileRefused& refused) {
      report(file->where, key, refused.path_and_reason(), refused.found(), refused.allowed());
    }
  }
  Value over = std::move(map);
  map = std::move(base);
  map.where = over.where;
  map.folder = over.folder;
  overlay(map, std::move(over));
}

Value load_opened(OutsideFile& file, Problems& problems, std::vector<std::string> including,
                  Extent& extent) {
  const std::string text = file.read_rest();
  including.push_back(resolved_path(file.path()));
  return parse_text(text, file.path().string(), file.path().parent_path().string(), problems,
                    std::move(including), extent);
}

}  // namespace

Value load_document(const std::string& file, Problems& problems) {
  Problem problem;
  problem.where = Location{std::make_shared<const std::string>(file), 0, 0};
  if (const auto fault = find_fault(file, TextShape::one_line)) {
    problem.what = "the file's name has " + fault->found + ", which is " + fault->what;
  } else {
    try {
      Extent extent;
      OutsideFile opened(file, kConfigurationFile);
      return load_opened(opened, problems, {}, extent);
    } catch (const FileRefused& refused) {
      problem.what = refused.missing() ? "no such file" : refused.reason();
      problem.found = refused.found();
      problem.allowed = refused.allowed();
      problem.suggestion = refused.missing() ? nearest_file(file) : "";
    }
  }
  Value empty;
  empty.kind = Value::Kind::map;
  empty.where = problem.where;
  problems.add(std::move(problem));
  return empty;
}

Value parse_document(const std::string& text, const std::string& name, const std::string& folder,
                     Problems& problems) {
  Extent extent;
  return parse_text(text, name, folder, problems, {}, extent);
}

Value parse_request(const std::string& text, const std::string& name, Problems& problems) {
  if (const auto fault = request_fault(text)) {
    const auto source = std::make_shared<const std::string>(name);
    const bool placed = !fault->mark.is_null();
    Value nothing;
    nothing.kind = Value::Kind::map;
    nothing.where =
        Location{source, placed ? fault->mark.line + 1 : 0, placed ? fault->mark.column + 1 : 0};
    problems.add({nothing.where, "", fault->what, fault->found, fault->allowed, ""});
    return nothing;
  }
  Extent extent;
  extent.may_include = false;
  extent.max_nodes = kMaximumRequestNodes;
  extent.max_bytes = kMaximumRequestBytes;
  return parse_text(text, name, ".", problems, {}, extent);
}

void overlay(Value& base, Value over) {
  if (base.kind != Value::Kind::map || over.kind != Value::Kind::map) {
    base = std::move(over);
    return;
  }
  std::unordered_map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < base.entries.size(); ++i) {
    places.emplace(base.entries[i].key, i);
  }
  for (Value::Entry& entry : over.entries) {
    const auto existing = places.find(entry.key);
    if (existing != places.end()) {
      overlay(base.entries[existing->second].value, std::move(entry.value));
    } else {
      base.entries.push_back(std::move(entry));
    }
  }
}

void apply_set(Value& document, const std::string& argument, Problems& problems) {
  const auto source = std::make_shared<const std::string>("--set " + argument);
  const Location where{source, 0, 0, std::numeric_limits<int>::max()};
  if (const auto fault = find_fault(argument, TextShape::lines)) {
    problems.add({where, "", fault->what, fault->found, "UTF-8 without control characters", ""});
    return;
  }
  const std::size_t equals = argument.find('=');
  const std::string path = argument.substr(0, equals);
  if (equals == std::string::npos || path.empty() || path.front() == '.' || path.back() == '.' ||
      path.find("..") != std::string::npos) {
    problems.add({where, "", "not an assignment", argument, "key.path=value", ""});
    return;
  }
  Problems own;
  std::error_code none;  // a working folder that is deleted has no name, and no files
  const std::string folder = fs::current_path(none).string();
  Value value =
      parse_document("value: " + argument.substr(equals + 1) + "\n", *source, folder, own);
  const Value* parsed = value.find("value");
  if (!own.empty() || parsed == nullptr || value.entries.size() != 1) {
    problems.add({where, path, "the value is not valid YAML", argument.substr(equals + 1), "", ""});
    return;
  }
  const auto relocate = [&](auto&& self, Value& node) -> void {
    node.where = where;
    for (Value& item : node.items) {
      self(self, item);
    }
    for (Value::Entry& entry : node.entries) {
      entry.where = where;
      self(self, entry.value);
    }
  };
  Value leaf = *parsed;
  relocate(relocate, leaf);

  Value* node = &document;
  std::istringstream segments(path);
  std::string segment;
  while (std::getline(segments, segment, '.')) {
    if (node->kind == Value::Kind::list) {
      std::size_t index = 0;
      const auto [end, error] =
          std::from_chars(segment.data(), segment.data() + segment.size(), index);
      if (error != std::errc{} || end != segment.data() + segment.size() ||
          index >= node->items.size()) {
        problems.add({where, path, "no such list element", segment,
                      fmt::format("0 .. {}", node->items.empty() ? 0 : node->items.size() - 1),
                      ""});
        return;
      }
      node = &node->items[index];
      continue;
    }
    if (node->kind == Value::Kind::scalar) {
      problems.add({where, path, "there is nothing below this key: \"" + segment + "\" not found",
                    "the value " + node->description(), "", ""});
      return;
    }
    if (node->kind == Value::Kind::null) {
      node->kind = Value::Kind::map;
      node->where = where;
    }
    if (Value* existing = node->find(segment)) {
      node = existing;
    } else {
      Value fresh;
      fresh.where = where;
      node->entries.push_back({segment, where, fresh});
      node = &node->entries.back().value;
    }
  }
  if (leaf.kind == Value::Kind::map && leaf.entries.empty() && node->kind == Value::Kind::map) {
    problems.add({where, path, "a map without keys changes nothing, for maps merge", "{}",
                  "keys with their new values", ""});
    return;
  }
  overlay(*node, std::move(leaf));
}

std::string nearest_file(const std::string& path) {
  const fs::path wanted(path);
  std::vector<std::string> names;
  std::error_code error;
  const fs::path folder = wanted.has_parent_path() ? wanted.parent_path() : fs::path(".");
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() != wanted.filename()) {
      names.push_back(it->path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  const std::string name = nearest_word(wanted.filename().string(), names);
  return name.empty() ? name : (wanted.parent_path() / name).string();
}

}  // namespace rigwire::hil
