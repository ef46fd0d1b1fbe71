#include "hil/rig/rig_settings.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "hil/configuration/outline.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {
namespace {

Value map_at(const Value& like) {
  return {.kind = Value::Kind::map,
          .scalar = {},
          .items = {},
          .entries = {},
          .where = like.where,
          .folder = like.folder};
}

/// A key to be set: "fov.start", whether it was written so or as "fov: {start: 10}".
struct Leaf {
  std::string path;
  Location where;
  const Value* value;
};
void append_leaves(const Value& map, const std::string& above, std::vector<Leaf>& leaves) {
  for (const Value::Entry& entry : map.entries) {
    const std::string path = above.empty() ? entry.key : above + "." + entry.key;
    if (entry.value.kind == Value::Kind::map && !entry.value.entries.empty()) {
      append_leaves(entry.value, path, leaves);
    } else {
      leaves.push_back({path, entry.where, &entry.value});
    }
  }
}

/// Builds the tree of a rig's file from its leaves. Precondition: groups have one level.
Value document_of(const std::vector<Leaf>& leaves, const Value& like) {
  Value document = map_at(like);
  for (const Leaf& leaf : leaves) {
    const std::size_t dot = leaf.path.find('.');
    Value* map = &document;
    if (dot != std::string::npos) {
      const std::string group = leaf.path.substr(0, dot);
      map = document.find(group);
      if (map == nullptr) {
        document.entries.push_back({group, leaf.where, map_at(like)});
        map = &document.entries.back().value;
      }
    }
    map->entries.push_back({leaf.path.substr(dot + 1), leaf.where, *leaf.value});
  }
  return document;
}

std::string text_of(const Value& value) {
  if (value.kind != Value::Kind::list) {
    return value.scalar;
  }
  std::vector<std::string> words;
  std::ranges::transform(value.items, std::back_inserter(words), &Value::scalar);
  return "[" + join_words(words) + "]";
}

std::vector<std::string> words_of(const std::vector<LiveKey>& keys) {
  std::vector<std::string> words;
  std::ranges::transform(keys, std::back_inserter(words),
                         [](const LiveKey& key) { return std::string(key.key); });
  return words;
}

}  // namespace

void RigSettings::add(const std::string& name, const DeviceConfiguration& configuration,
                      Device& device) {
  if (!configuration.live_keys().empty()) {
    entries_.push_back({name, configuration.copy(), &device});
  }
}

std::vector<std::string> RigSettings::names() const {
  std::vector<std::string> names;
  std::ranges::transform(entries_, std::back_inserter(names), &Entry::name);
  return names;
}

std::vector<LiveKey> RigSettings::keys(const std::string& name) const {
  const auto entry = std::ranges::find(entries_, name, &Entry::name);
  return entry == entries_.end() ? std::vector<LiveKey>{} : entry->configuration->live_keys();
}

std::string RigSettings::value(const std::string& name, std::string_view key) const {
  const auto entry = std::ranges::find(entries_, name, &Entry::name);
  const auto copy = entry->configuration->copy();
  const OutlineNode keys = outline_part(fields::Part::of(*copy));
  const OutlineNode* node = &keys;
  for (std::size_t from = 0; from < key.size();) {
    const std::size_t dot = std::min(key.find('.', from), key.size());
    node = &*std::ranges::find(node->children, key.substr(from, dot - from), &OutlineNode::key);
    from = dot + 1;
  }
  return node->value;
}

RigSettings::Outcome RigSettings::tell(SimTime now, const std::string& name, const Value& keys) {
  Entry& entry = *std::ranges::find(entries_, name, &Entry::name);
  const std::vector<LiveKey> live = entry.configuration->live_keys();
  std::vector<Leaf> leaves;
  append_leaves(keys, "", leaves);
  Problems problems;
  for (const Leaf& leaf : leaves) {
    if (std::ranges::count(live, leaf.path, &LiveKey::key) == 0) {
      problems.add({leaf.where, leaf.path, "cannot be changed while it runs",
                    leaf.value->description(), join_words(words_of(live)),
                    nearest_word(leaf.path, words_of(live))});
    } else if (std::ranges::count(leaves, leaf.path, &Leaf::path) > 1) {
      problems.add({leaf.where, leaf.path, "written twice", {}, {}, {}});
    }
  }
  // Builds the configuration from a list of leaves.
  const auto configured = [&](const std::vector<Leaf>& with) {
    Origins origins;
    std::unique_ptr<DeviceConfiguration> configuration = entry.configuration->copy();
    const Value document = document_of(with, keys);
    Reader(document, problems, origins).read(fields::Part::of(*configuration));
    return configuration;
  };
  std::unique_ptr<DeviceConfiguration> wanted;
  if (problems.empty()) {
    wanted = configured(leaves);
  }
  Outcome outcome;
  if (!problems.empty()) {
    outcome.refused = problems.sorted().front();
    return outcome;
  }
  std::vector<Leaf> told;
  for (const LiveKey& key : live) {
    const auto leaf = std::ranges::find(leaves, key.key, &Leaf::path);
    if (leaf == leaves.end()) {
      continue;
    }
    if (const std::string why = entry.device->tell(now, *wanted, key.key); !why.empty()) {
      outcome.refused = {leaf->where,           leaf->path, name + " does not take it: " + why,
                         text_of(*leaf->value), {},         {}};
      outcome.by_device = true;
      wanted = configured(told);
      break;
    }
    told.push_back(*leaf);
    outcome.told.push_back({leaf->path, text_of(*leaf->value)});
  }
  entry.configuration = std::move(wanted);
  return outcome;
}

}  // namespace rigwire::hil
