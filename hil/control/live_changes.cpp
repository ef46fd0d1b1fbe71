#include "hil/control/live_changes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "hil/configuration/plain_text.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {
namespace {

using Json = nlohmann::ordered_json;

/// The machine's name in `set`.
constexpr std::string_view kMachine = "machine";

/// Manual overrides of the air: faults of it (sim/weather/air_fault.h), each with the key of its
/// strength.
constexpr std::string_view kAir = "air";
struct AirKey {
  std::string_view kind;
  std::string_view key;
};
constexpr std::array<AirKey, 3> kAirKeys{
    {{"rain", "rate"}, {"snow", "rate"}, {"fog", "visibility"}}};

std::vector<std::string> air_names() {
  std::vector<std::string> names;
  std::ranges::transform(kAirKeys, std::back_inserter(names),
                         [](const AirKey& key) { return std::string(key.kind); });
  return names;
}

Value scalar_like(const Value& like, std::string text) {
  return {.kind = Value::Kind::scalar,
          .scalar = std::move(text),
          .items = {},
          .entries = {},
          .where = like.where,
          .folder = like.folder};
}

Ruling acts_from(SimTime instant) {
  return {.told = {{"acts_from_ns", nanoseconds(instant)}}};
}

}  // namespace

Ruling LiveChanges::begin(const FaultAddCommand& command) {
  Problems problems;
  Value keys = command.keys ? *command.keys : parse_request(command.fault, "fault", problems);
  const Value* const type_key = keys.find("type");
  if (problems.empty() && (type_key == nullptr || type_key->kind != Value::Kind::scalar)) {
    return wrong({{"what", "the fault has no type"},
                  {"path", "fault"},
                  {"found", printable(shortened(command.fault))},
                  {"allowed", "keys as in a rig's file: {type: jamming, for: 5 s}"}});
  }
  try {
    const auto begun =
        problems.empty() ? begin_fault(command.on, std::move(keys), problems) : std::nullopt;
    return begun ? Ruling{.told = {{"fault", json_of(*begun)}}} : wrong(problems);
  } catch (const NoSuchFault& error) {
    return wrong(json_of(error));
  } catch (const std::invalid_argument& error) {
    return wrong({{"what", error.what()}, {"path", "fault"}});
  }
}

std::optional<RigFaults::Numbered> LiveChanges::begin_fault(const std::string& on, Value keys,
                                                            Problems& problems) {
  Origins origins;
  const auto fill = [&](const fields::Part& fault, SimTime soonest) {
    if (keys.find("at") == nullptr) {
      keys.entries.push_back(
          {"at", keys.where, scalar_like(keys, fmt::format("{} ns", nanoseconds(soonest)))});
    }
    Reader(keys, problems, origins).read(fault);
    return problems.empty();
  };
  auto begun = parts_.faults.begin(parts_.executive.now(), on, keys.find("type")->scalar, fill);
  if (begun) {
    // With the instant at which it begins.
    note({{"verb", "fault_add"}, {"on", on}, {"fault", json_text(keys)}});
  }
  return begun;
}

Ruling LiveChanges::end(const FaultClearCommand& command) {
  try {
    return {.told = {{"fault", json_of(end_fault(command.id))}}};
  } catch (const NoSuchFault& error) {
    return wrong(json_of(error));
  }
}

RigFaults::Numbered LiveChanges::end_fault(RigFaults::Id id) {
  RigFaults::Numbered ended = parts_.faults.end(parts_.executive.now(), id);
  std::erase_if(air_, [id](const auto& brought) { return brought.second.id == id; });
  note({{"verb", "fault_clear"}, {"id", id}});
  return ended;
}

std::vector<std::string> LiveChanges::things() const {
  std::vector<std::string> all;
  if (parts_.hand != nullptr && !parts_.hand->settings().rows().empty()) {
    all.emplace_back(kMachine);
  }
  if (has_air()) {
    all.emplace_back(kAir);
  }
  if (parts_.settings != nullptr) {
    std::ranges::copy(parts_.settings->names(), std::back_inserter(all));
  }
  return all;
}

std::vector<std::string> LiveChanges::keys(const std::string& on) const {
  if (on == kMachine && parts_.hand != nullptr) {
    return parts_.hand->settings().names();
  }
  if (on == kAir && has_air()) {
    return air_names();
  }
  std::vector<std::string> names;
  if (parts_.settings != nullptr) {
    for (const LiveKey& key : parts_.settings->keys(on)) {
      names.emplace_back(key.key);
    }
  }
  return names;
}

std::string LiveChanges::value(const std::string& on, const std::string& key) const {
  if (on == kMachine) {
    const auto held = held_.find(key);
    return held == held_.end() ? std::string() : held->second;
  }
  if (on == kAir) {
    const auto brought = air_.find(key);
    return brought == air_.end() ? std::string() : brought->second.value;
  }
  return parts_.settings->value(on, key);
}

std::vector<LiveChanges::Setting> LiveChanges::settings() const {
  std::vector<Setting> all;
  for (const std::string& thing : things()) {
    for (const std::string& key : keys(thing)) {
      all.push_back({thing, key, value(thing, key)});
    }
  }
  return all;
}

Ruling LiveChanges::set(const SetCommand& command) {
  const std::vector<std::string> allowed = keys(command.on);
  if (allowed.empty()) {
    return wrong({{"what", "nothing of that name can be set"},
                  {"path", "on"},
                  {"found", printable(shortened(command.on))},
                  {"allowed", join_words(things())}});
  }
  Problems problems;
  const Value keys = command.keys ? *command.keys : parse_request(command.set, "set", problems);
  if (!problems.empty()) {
    return wrong(problems);
  }
  if (keys.kind != Value::Kind::map || keys.entries.empty()) {
    return wrong({{"what", command.on == kMachine ? "no set points" : "no keys"},
                  {"path", "set"},
                  {"found", printable(shortened(command.set))},
                  {"allowed", "some of " + join_words(allowed)}});
  }
  if (command.on == kMachine) {
    return set_machine(command, keys);
  }
  return command.on == kAir ? set_air(keys) : set_device(command, keys);
}

Ruling LiveChanges::set_machine(const SetCommand& command, const Value& keys) {
  Problems problems;
  Origins origins;
  HandSettings settings = parts_.hand->settings();
  // A released set point has no value to be read.
  Value taken = keys;
  std::vector<std::string> released;
  std::erase_if(taken.entries, [&](const Value::Entry& entry) {
    const bool lets_go =
        entry.value.kind == Value::Kind::null && settings.find(entry.key) != nullptr;
    if (lets_go) {
      released.push_back(entry.key);
    }
    return lets_go;
  });
  Reader(taken, problems, origins).read(fields::Part::of(settings));
  if (!problems.empty()) {
    return wrong(problems);
  }
  std::vector<Hand::Order> orders;
  for (const Value::Entry& entry : taken.entries) {
    const HandSettings::Row& row = *settings.find(entry.key);
    orders.push_back({row, row.value});
    held_[row.name] = entry.value.scalar;
    tell(EventKind::set, row.name,
         fmt::format("manual override: {} = {}", row.name, entry.value.scalar));
  }
  for (const std::string& name : released) {
    orders.push_back({*settings.find(name), std::nullopt});
    held_.erase(name);
    tell(EventKind::released, name, fmt::format("manual override: {} released", name));
  }
  const SimTime from = parts_.executive.soonest_request();
  for (const Hand::Order& order : orders) {
    parts_.executive.ask(order);
  }
  note({{"verb", "set"}, {"on", command.on}, {"set", command.set}});
  return acts_from(from);
}

Ruling LiveChanges::set_air(const Value& keys) {
  struct Change {
    const AirKey* of;
    std::optional<std::string> value;  ///< Empty: released.
  };
  // All of them are checked before the first one acts.
  std::vector<Change> changes;
  for (const Value::Entry& entry : keys.entries) {
    const auto* const of = std::ranges::find(kAirKeys, entry.key, &AirKey::kind);
    const bool lets_go = entry.value.kind == Value::Kind::null;
    if (of == kAirKeys.end() || !(lets_go || entry.value.kind == Value::Kind::scalar)) {
      const bool unknown = of == kAirKeys.end();
      return wrong(
          {{"what", unknown ? "unknown kind of weather" : "no value"},
           {"path", printable(shortened(entry.key))},
           {"found", printable(entry.value.description())},
           {"allowed", unknown ? join_words(air_names()) : "a value with its unit, or null"}});
    }
    changes.push_back({of, lets_go ? std::nullopt : std::optional(entry.value.scalar)});
  }
  std::vector<std::pair<const AirKey*, Brought>> begun;
  SimTime from = parts_.executive.now();
  for (const Change& change : changes) {
    if (!change.value) {
      continue;
    }
    Value fault = keys;
    fault.entries = {{"type", keys.where, scalar_like(keys, std::string(change.of->kind))},
                     {std::string(change.of->key), keys.where, scalar_like(keys, *change.value)}};
    Problems problems;
    if (const auto one = begin_fault(std::string(kAir), std::move(fault), problems)) {
      begun.emplace_back(change.of, Brought{one->id, *change.value});
      from = std::max(from, one->window.begin);
    } else {
      for (const auto& [of, brought] : begun) {
        end_fault(brought.id);
      }
      Ruling refusal = wrong(problems);
      refusal.told["path"] = change.of->kind;
      return refusal;
    }
  }
  for (const Change& change : changes) {
    const std::string kind(change.of->kind);
    if (const auto before = air_.find(kind); before != air_.end()) {
      from = std::max(from, end_fault(before->second.id).window.end);
    }
    if (change.value) {
      tell(EventKind::set, std::string(kAir), fmt::format("{} is set to {}", kind, *change.value));
    } else {
      tell(EventKind::released, std::string(kAir),
           fmt::format("manual override: {} released", kind));
    }
  }
  for (auto& [of, brought] : begun) {
    air_[std::string(of->kind)] = std::move(brought);
  }
  return acts_from(from);
}

Ruling LiveChanges::set_device(const SetCommand& command, const Value& keys) {
  const SimTime now = parts_.executive.now();
  const RigSettings::Outcome outcome = parts_.settings->tell(now, command.on, keys);
  Json told = Json::object();
  for (const RigSettings::Outcome::Told& one : outcome.told) {
    told[one.key] = printable(one.value);
    tell(EventKind::set, command.on, fmt::format("{} is set to {}", one.key, one.value));
  }
  if (!outcome.told.empty()) {
    note({{"verb", "set"}, {"on", command.on}, {"set", command.set}});
  }
  if (!outcome.refused) {
    return acts_from(now);
  }
  Json why = json_of(*outcome.refused);
  why["told"] = std::move(told);
  return outcome.by_device ? refused(std::move(why)) : wrong(std::move(why));
}

Json LiveChanges::set_points() const {
  Json all = Json::array();
  if (parts_.hand != nullptr) {
    for (const HandSettings::Row& row : parts_.hand->settings().rows()) {
      Json& told = all.emplace_back(Json{{"name", row.name}});
      if (row.kind == HandSettings::Kind::opening) {
        told["least"] = -1;
        told["most"] = 1;
      }
    }
  }
  return all;
}

Json LiveChanges::air() const {
  if (!has_air()) {
    return nullptr;
  }
  Json values = Json::object();
  for (const std::string& kind : air_names()) {
    const auto brought = air_.find(kind);
    values[kind] = brought == air_.end() ? Json(nullptr) : Json(printable(brought->second.value));
  }
  return values;
}

bool LiveChanges::has_air() const {
  const auto targets = parts_.faults.targets();
  return std::ranges::any_of(targets, [](const auto& target) { return target.name == kAir; });
}

void LiveChanges::tell(EventKind kind, const std::string& where, const std::string& text) {
  if (parts_.events != nullptr) {
    parts_.events->tell(parts_.executive.now(), kind, LogLevel::info, where, text);
  }
}

void LiveChanges::note(const Json& request) {
  if (parts_.recorder != nullptr) {
    parts_.recorder->command(request.dump());
  }
}

}  // namespace rigwire::hil
