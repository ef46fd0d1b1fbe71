#include "hil/configuration/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/samples/time.h"

namespace rigwire::hil {

using fields::NumberRule;

namespace {

/// YAML that reads back as exactly this text.
std::string yaml_text(const std::string& text) {
  const bool safe = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '/' || c == '.' || c == '-';
  });
  const bool word = safe && text != "true" && text != "false" && text != "null" && text != "-" &&
                    text.front() != '.' && !(text.front() == '-' && text.size() == 1);
  if (word) {
    return text;
  }
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      result += fmt::format("\\x{:02x}", byte);
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string canonical_number(double value) {
  return fmt::format("{}", value == 0.0 ? 0.0 : value);
}

/// Whole numbers of a std::uint64_t come in two's complement.
std::string whole_text(std::int64_t value, bool unsigned_64) {
  return unsigned_64 ? std::to_string(static_cast<std::uint64_t>(value)) : std::to_string(value);
}

class Outliner final : public fields::Visitor {
 public:
  /// `everything`: what there can be, not only what there is.
  explicit Outliner(bool everything) : everything_(everything) { stack_.push_back(&root_); }
  Outliner(const Outliner&) = delete;
  Outliner& operator=(const Outliner&) = delete;

  [[nodiscard]] OutlineNode take() && { return std::move(root_); }

  void required(std::string_view key) override { required_ = key; }
  void refused(std::string_view, std::string_view) override {}
  void conditional(bool holds, std::string_view, std::string_view needs,
                   const fields::Part& keys) override {
    if (!holds && !everything_) {
      return;
    }
    std::vector<OutlineNode>& nodes = stack_.back()->children;
    const std::size_t first = nodes.size();
    keys.show(*this);
    for (std::size_t i = first; everything_ && i < nodes.size(); ++i) {
      nodes[i].needs = nodes[i].needs.empty() ? needs : std::string(needs) + ", " + nodes[i].needs;
    }
  }
  void check(bool, std::string_view, const std::string&, const std::string&,
             const std::string&) override {}

  void number(std::string_view key, double& value, const NumberRule& rule,
              std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, "number", text);
    node.unit = rule.written().symbol;
    node.allowed = rule.range_text();
    node.value = rule.print(value);
    node.canonical = canonical_number(value);
  }
  void numbers(std::string_view key, std::span<double> values, const NumberRule& rule,
               std::string_view text) override {
    OutlineNode& node =
        add(OutlineNode::Kind::flow_list, key, values.size() == 3 ? "[x, y, z]" : "numbers", text);
    node.unit = rule.written().symbol;
    node.allowed = rule.range_text();
    for (const double value : values) {
      node.value += (node.value.empty() ? "" : ", ") + rule.print(value);
      node.canonical += (node.canonical.empty() ? "" : ",") + canonical_number(value);
    }
    node.value = fmt::format("[{}]", node.value);
  }
  void number_list(std::string_view key, std::vector<double>& values, const NumberRule& rule,
                   std::string_view text) override {
    numbers(key, values, rule, text);
    stack_.back()->children.back().type = "numbers";
  }
  void whole(std::string_view key, std::int64_t& value, const fields::IntegerRule& rule,
             bool unsigned_64, std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, "whole number", text);
    node.allowed = rule.range_text();
    node.canonical = whole_text(value, unsigned_64);
    node.value = node.canonical;
    if (rule.unit != nullptr) {
      node.unit = rule.unit->symbol;
      node.value += " " + node.unit;
    }
  }
  void boolean(std::string_view key, bool& value, std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, "yes or no", text);
    node.allowed = "true, false";
    node.value = node.canonical = value ? "true" : "false";
  }
  void text(std::string_view key, std::string& value, std::string_view text) override {
    name(key, "text", value, "", text);
  }
  void texts(std::string_view key, std::vector<std::string>& values,
             std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::flow_list, key, "list of words", text);
    for (const std::string& value : values) {
      node.value += (node.value.empty() ? "" : ", ") + yaml_text(value);
      node.canonical += yaml_text(value) + ",";
    }
    node.value = fmt::format("[{}]", node.value);
  }
  void file(std::string_view key, std::string& value, fields::FileKind kind,
            std::string_view text) override {
    name(key, "file", value, "", text);
    stack_.back()->children.back().file = kind;
  }
  void duration(std::string_view key, std::chrono::nanoseconds& value,
                const fields::DurationRule& rule, std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, "duration", text);
    node.unit = "s";
    node.allowed = rule.range_text();
    node.value = fields::print_duration(value.count());
    node.canonical = std::to_string(value.count());
  }
  void rate(std::string_view key, std::chrono::nanoseconds& period, const NumberRule& rule,
            std::string_view text) override {
    const double hertz = period.count() > 0 ? 1e9 / static_cast<double>(period.count()) : 0.0;
    // The shortest number of hertz that still means this period.
    std::string shown = rule.print(hertz);
    for (int digits = 3; digits < 17 && hertz > 0.0; ++digits) {
      const double rounded = std::stod(fmt::format("{:.{}g}", hertz, digits));
      if (rounded > 0.0 && from_seconds(1.0 / rounded) == period) {
        shown = rule.print(rounded);
        break;
      }
    }
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, "rate", text);
    node.unit = rule.written().symbol;
    node.allowed = rule.range_text();
    node.value = shown;
    node.canonical = std::to_string(period.count());
  }
  void spelled(std::string_view key, const fields::Spelling& spelling,
               std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, spelling.type, text);
    node.value = node.canonical = spelling.print();
  }
  void pick(std::string_view key, std::size_t& index, std::span<const fields::Named> names,
            std::string_view text) override {
    const std::string chosen = index < names.size() ? std::string(names[index].name) : "";
    name(key, "choice", chosen, listed(names), text);
  }

  void part(std::string_view key, const fields::Part& part, std::string_view text) override {
    descend(add(OutlineNode::Kind::section, key, "section", text), part);
  }
  void elements(std::string_view key, fields::Elements& list, std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::list, key, "list", text);
    if (everything_) {
      list.clear();
      list.append();
    }
    node.children.reserve(list.size());
    for (std::size_t index = 0; index < list.size(); ++index) {
      OutlineNode& child = node.children.emplace_back();
      child.key = everything_ ? "each" : std::to_string(index);
      descend(child, list.at(index));
    }
  }
  void members(std::string_view key, fields::Members& map, std::string_view noun,
               std::string_view text) override {
    OutlineNode& node = add(OutlineNode::Kind::named, key, noun, text);
    const std::vector<std::string> names = map.names();
    node.children.reserve(names.size());
    for (const std::string& member : names) {
      OutlineNode& child = node.children.emplace_back();
      child.key = member;
      child.type = noun;
      descend(child, map.at(member));
    }
  }
  void alternatives(std::string_view key, fields::Alternatives& types,
                    std::string_view text) override {
    const std::vector<fields::Named> names = types.names();
    const std::size_t chosen = types.index();
    name(key, "choice", std::string(names[chosen].name), listed(names), text);
    if (!everything_ || stack_.size() == 1) {
      types.chosen().show(*this);
      return;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      types.choose(i);
      const std::string when = fmt::format("with {} {}", key, names[i].name);
      descend(add(OutlineNode::Kind::section, when, "", names[i].text), types.chosen());
    }
    types.choose(chosen);
  }

 private:
  OutlineNode& add(OutlineNode::Kind kind, std::string_view key, std::string_view type,
                   std::string_view text) {
    OutlineNode& node = stack_.back()->children.emplace_back();
    node.kind = kind;
    node.key = key;
    node.type = type;
    node.text = text;
    node.required = required_ == key;
    required_.clear();
    return node;
  }
  void name(std::string_view key, std::string_view type, const std::string& value,
            std::string allowed, std::string_view text) {
    OutlineNode& node = add(OutlineNode::Kind::scalar, key, type, text);
    node.allowed = std::move(allowed);
    node.canonical = value;
    node.value = yaml_text(value);
  }
  void descend(OutlineNode& node, const fields::Part& part) {
    stack_.push_back(&node);
    part.show(*this);
    stack_.pop_back();
  }
  static std::string listed(std::span<const fields::Named> names) {
    std::string text;
    for (const fields::Named& named : names) {
      text += (text.empty() ? "" : ", ") + std::string(named.name);
    }
    return text;
  }

  bool everything_;
  OutlineNode root_;
  std::vector<OutlineNode*> stack_;
  std::string required_;
};

}  // namespace

OutlineNode outline_part(const fields::Part& part) {
  Outliner outliner(false);
  part.show(outliner);
  return std::move(outliner).take();
}

OutlineNode reference_outline_part(const fields::Part& part) {
  Outliner outliner(true);
  part.show(outliner);
  return std::move(outliner).take();
}

std::uint64_t fnv1a(std::string_view bytes, std::uint64_t basis) {
  for (const char c : bytes) {
    basis = (basis ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  }
  return basis;
}

namespace {

std::string child_path(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

class YamlPrinter {
 public:
  explicit YamlPrinter(const Origins& origins) : origins_(origins) {}

  void map(const OutlineNode& node, const std::string& path, std::size_t indent,
           std::string first_prefix) {
    for (const OutlineNode& child : node.children) {
      const std::string prefix =
          first_prefix.empty() ? std::string(indent, ' ') : std::exchange(first_prefix, "");
      entry(child, child_path(path, child.key), indent, prefix + child.key + ":");
    }
  }

  std::string take() && { return std::move(text_); }

 private:
  void entry(const OutlineNode& node, const std::string& path, std::size_t indent,
             const std::string& head) {
    switch (node.kind) {
      case OutlineNode::Kind::scalar:
      case OutlineNode::Kind::flow_list:
        line(head + " " + node.value, path);
        return;
      case OutlineNode::Kind::section:
      case OutlineNode::Kind::named:
        if (node.children.empty()) {
          line(head + " {}", path);
          return;
        }
        text_ += head + "\n";
        map(node, path, indent + 2, "");
        return;
      case OutlineNode::Kind::list:
        if (node.children.empty()) {
          line(head + " []", path);
          return;
        }
        text_ += head + "\n";
        for (const OutlineNode& item : node.children) {
          map(item, child_path(path, item.key), indent + 4, std::string(indent + 2, ' ') + "- ");
        }
        return;
    }
  }

  void line(std::string content, const std::string& path) {
    constexpr std::size_t kCommentColumn = 52;
    if (content.size() < kCommentColumn) {
      content.append(kCommentColumn - content.size(), ' ');
    }
    text_ += content + "  # " + origins_.of(path).line_text() + "\n";
  }

  const Origins& origins_;
  std::string text_;
};

void collect(const OutlineNode& node, const std::string& path, const FileContent& content,
             std::vector<std::string>& lines) {
  for (const OutlineNode& child : node.children) {
    const std::string below = child_path(path, child.key);
    if (child.kind == OutlineNode::Kind::scalar || child.kind == OutlineNode::Kind::flow_list) {
      lines.push_back(below + "=" +
                      (child.file ? content(child.canonical, *child.file) : child.canonical));
    } else {
      lines.push_back(below + ":");
      collect(child, below, content, lines);
    }
  }
}

void refer(const OutlineNode& node, std::size_t indent, std::string& text) {
  for (const OutlineNode& child : node.children) {
    std::string line = std::string(indent, ' ') + child.key + ":";
    line += child.type.empty() ? "" : " " + child.type;
    line += child.unit.empty() ? "" : " in " + child.unit;
    line += child.allowed.empty() ? "" : ", " + child.allowed;
    line += child.value.empty() ? "" : ", default " + child.value;
    line += child.required ? ", required" : "";
    line += child.needs.empty() ? "" : ", with " + child.needs;
    text += line + "\n";
    text += child.text.empty() ? "" : std::string(indent + 4, ' ') + child.text + "\n";
    refer(child, indent + 2, text);
  }
}

}  // namespace

std::string print_yaml(const OutlineNode& tree, const Origins& origins) {
  YamlPrinter printer(origins);
  printer.map(tree, "", 0, "");
  return std::move(printer).take();
}

std::string hash_text(const OutlineNode& tree, const FileContent& content) {
  std::vector<std::string> lines;
  collect(tree, "", content, lines);
  std::sort(lines.begin(), lines.end());
  std::uint64_t hash = fnv1a("");
  for (const std::string& line : lines) {
    hash = fnv1a(line + "\n", hash);
  }
  return fmt::format("{:016x}", hash);
}

std::string reference_text(const OutlineNode& tree) {
  std::string text;
  refer(tree, 0, text);
  return text;
}

}  // namespace rigwire::hil
