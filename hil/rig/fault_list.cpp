#include "hil/rig/fault_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"
#include "hil/devices/device_types.h"
#include "hil/world/surroundings.h"
#include "sim/gnss/gnss_fault.h"

namespace rigwire::hil {
namespace {

constexpr std::string_view kList = "faults";
constexpr std::string_view kSky = "sky";

/// Something of the document that can have faults; `part` holds its list.
struct Target {
  std::string name;
  std::string path;
  Value* part;
  bool has_antenna = false;
};

/// The kinds of that type of device; nothing where there is none.
std::vector<fields::Named> kinds_of(const Value& device) {
  const Value* const type = device.find("type");
  for (const DeviceType& row : device_types()) {
    if (type != nullptr && type->scalar == row.named.name) {
      return row.fresh()->fault_kinds();
    }
  }
  return {};
}

/// The map under a key of that one, made where it is not there.
Value& map_at(Value& map, std::string_view key, const Value& like) {
  if (Value* found = map.find(key)) {
    return *found;
  }
  map.entries.push_back({std::string(key), like.where,
                         Value{.kind = Value::Kind::map,
                               .scalar = {},
                               .items = {},
                               .entries = {},
                               .where = like.where,
                               .folder = like.folder}});
  return map.entries.back().value;
}

/// Surroundings that something of the list is on have a place for it.
void make_surroundings_for(const Value& list, Value& document) {
  for (const Value& fault : list.items) {
    const Value* const on = fault.find("on");
    const auto* const target = on == nullptr ? kSurroundingsTargets.end()
                                             : std::ranges::find(kSurroundingsTargets, on->scalar,
                                                                 &SurroundingsTarget::name);
    if (target != kSurroundingsTargets.end()) {
      Value& around = map_at(document, kSurroundings, fault);
      if (around.kind == Value::Kind::map) {  // else the reader complains of it
        map_at(around, target->key, fault);
      }
    }
  }
}

std::vector<Target> targets_of(Value& document) {
  std::vector<Target> targets;
  const auto each = [&](std::string_view section, const std::string& prefix) {
    Value* const parts = document.find(section);
    if (parts == nullptr) {
      return;
    }
    for (Value::Entry& entry : parts->entries) {
      if (entry.value.kind != Value::Kind::map) {
        continue;
      }
      const bool is_device = prefix.empty();
      const std::vector<fields::Named> kinds =
          is_device ? kinds_of(entry.value) : std::vector<fields::Named>{};
      if (!is_device || !kinds.empty()) {
        const bool antenna =
            std::ranges::count(kinds, sim::OutageFault::kNamed.name, &fields::Named::name) > 0;
        targets.push_back(
            {prefix + entry.key, std::string(section) + "." + entry.key, &entry.value, antenna});
      }
    }
  };
  each("devices", "");
  each("buses", "bus ");
  each("modbus", "modbus ");
  if (Value* around = document.find(kSurroundings)) {
    for (const SurroundingsTarget& target : kSurroundingsTargets) {
      Value* const part = around->find(target.key);
      if (part != nullptr && part->kind == Value::Kind::map) {
        targets.push_back(
            {std::string(target.name), fmt::format("{}.{}", kSurroundings, target.key), part});
      }
    }
  }
  return targets;
}

void append(const Target& target, const Value& fault, const std::string& written,
            Origins& origins) {
  Value& part = *target.part;
  Value* list = part.find(kList);
  if (list == nullptr) {
    Value empty{.kind = Value::Kind::list,
                .scalar = {},
                .items = {},
                .entries = {},
                .where = fault.where,
                .folder = fault.folder};
    part.entries.push_back({std::string(kList), fault.where, std::move(empty)});
    list = &part.entries.back().value;
  }
  if (list->kind == Value::Kind::list) {  // else the reader complains of it
    origins.moved(fmt::format("{}.{}.{}", target.path, kList, list->items.size()), written);
    list->items.push_back(fault);
  }
}

}  // namespace

void bring_faults_home(Value& document, Problems& problems, Origins& origins) {
  const auto found = std::ranges::find(document.entries, kList, &Value::Entry::key);
  if (found == document.entries.end()) {
    return;
  }
  const Value list = std::move(found->value);
  document.entries.erase(found);
  if (list.kind != Value::Kind::list) {
    problems.add(
        {list.where, std::string(kList), "wrong kind of value", list.description(), "a list", {}});
    return;
  }
  make_surroundings_for(list, document);
  const std::vector<Target> targets = targets_of(document);
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    Value fault = list.items[i];
    const std::string path = std::string(kList) + "." + std::to_string(i);
    if (fault.kind != Value::Kind::map) {
      problems.add(
          {fault.where, path, "wrong kind of value", fault.description(), "a map of keys", {}});
      continue;
    }
    const auto on = std::ranges::find(fault.entries, "on", &Value::Entry::key);
    if (on == fault.entries.end()) {
      problems.add({fault.where, path + ".on", "missing key", {}, {}, {}});
      continue;
    }
    const Value name = std::move(on->value);
    fault.entries.erase(on);
    bool known = false;
    for (const Target& target : targets) {
      if (name.scalar == kSky ? target.has_antenna : target.name == name.scalar) {
        append(target, fault, path, origins);
        known = true;
      }
    }
    if (!known) {
      std::vector<std::string> names;
      for (const Target& target : targets) {
        if (std::ranges::count(kSurroundingsTargets, target.name, &SurroundingsTarget::name) == 0) {
          names.push_back(target.name);
        }
      }
      for (const SurroundingsTarget& target : kSurroundingsTargets) {
        names.emplace_back(target.name);
      }
      if (std::ranges::any_of(targets, &Target::has_antenna)) {
        names.emplace_back(kSky);
      }
      problems.add({name.where, path + ".on", "nothing of that name can have faults",
                    name.description(), join_words(names), nearest_word(name.scalar, names)});
    }
  }
}

}  // namespace rigwire::hil
