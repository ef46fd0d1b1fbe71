#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "fields/visitor.h"
#include "hil/command_line/config_files.h"
#include "hil/command_line/verbs.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/schema.h"
#include "hil/configuration/suggest.h"
#include "hil/devices/device_types.h"
#include "hil/files/dbc_node_file.h"
#include "hil/files/dbc_node_table.h"
#include "hil/files/valve_map_file.h"
#include "hil/rig/fault_list.h"
#include "hil/rig/rig_configuration.h"
#include "protocols/dbc/dbc_writer.h"

namespace rigwire::hil {

namespace {

/// A device type with its defaults, as it is described.
struct DescribedType {
  fields::Named named;
  DeviceDescription description;
  bool has_faults = false;  ///< A rig can order some of it.
  std::vector<LiveKey> live_keys;
  std::string keys;  ///< Reference of the configuration keys.
};

DescribedType describe_type(std::size_t row) {
  const DeviceType& type = device_types()[row];
  const ConfiguredDevice device(row);
  OutlineNode outline = reference_outline(device);
  for (OutlineNode& key : outline.children) {
    if (key.key == "type") {
      key.allowed.clear();  // only this one has the keys below
    }
  }
  DescribedType described{
      type.named, device->describe(),
      std::ranges::find(outline.children, "faults", &OutlineNode::key) != outline.children.end(),
      device->live_keys(), reference_text(outline)};
  if (described.description.page.empty()) {
    described.description.page = fmt::format("docs/devices/{}.md", type.named.name);
  }
  return described;
}

/// Six digits; ten of a large one, so that it needs no exponent.
std::string limit_text(double limit) {
  const double size = std::abs(limit);
  return size >= 1e6 && size < 1e10 ? fmt::format("{:.10g}", limit) : fmt::format("{:.6g}", limit);
}

std::string text_of(const DescribedType& type) {
  const DeviceDescription& description = type.description;
  std::string text = fmt::format(
      "{}: {}\n\nwire      {}\nfollows   {}\npage      {}\nfaults    {}\n", type.named.name,
      type.named.text, description.wire, description.document, page_file(description.page),
      type.has_faults ? "its key `faults`, below" : "none; see those of its wire");
  if (!type.live_keys.empty()) {
    std::vector<std::string> keys;
    std::ranges::transform(type.live_keys, std::back_inserter(keys),
                           [](const LiveKey& key) { return std::string(key.key); });
    text += fmt::format("settable  {}, while it runs (docs/control.md)\n", join_words(keys));
  }
  std::vector<std::vector<std::string>> rows{{"message", "rate", "content"}};
  for (const DeviceMessage& message : description.messages) {
    rows.push_back({message.name, message.rate, message.content});
  }
  text += "\n" + table_text(rows);
  if (!description.quantities.empty()) {
    rows = {{"quantity", "unit", "from", "to", "resolution"}};
    for (const DescribedQuantity& quantity : description.quantities) {
      rows.push_back({quantity.name, quantity.unit, limit_text(quantity.lower),
                      limit_text(quantity.upper), fmt::format("{:.6g}", quantity.resolution)});
    }
    text += "\n" + table_text(rows);
  }
  return text + "\nkeys in a rig (docs/configuration.md)\n" + type.keys;
}

nlohmann::ordered_json json_of(const DescribedType& type) {
  const DeviceDescription& description = type.description;
  nlohmann::ordered_json json{{"type", type.named.name},
                              {"text", type.named.text},
                              {"wire", description.wire},
                              {"document", description.document},
                              {"page", description.page},
                              {"faults", type.has_faults},
                              {"settable", nlohmann::ordered_json::array()},
                              {"messages", nlohmann::ordered_json::array()},
                              {"quantities", nlohmann::ordered_json::array()}};
  for (const LiveKey& key : type.live_keys) {
    json["settable"].push_back({{"key", key.key}, {"by", key.by}});
  }
  for (const DeviceMessage& message : description.messages) {
    json["messages"].push_back(
        {{"name", message.name}, {"rate", message.rate}, {"content", message.content}});
  }
  for (const DescribedQuantity& quantity : description.quantities) {
    json["quantities"].push_back({{"name", quantity.name},
                                  {"unit", quantity.unit},
                                  {"lower", quantity.lower},
                                  {"upper", quantity.upper},
                                  {"resolution", quantity.resolution}});
  }
  return json;
}

/// Returns the type of a device of that name in the installed rigs; empty when none has it.
std::string type_in_rigs(const std::string& device) {
  for (const ConfigFile& rig : config_files("rigs")) {
    try {
      const RigConfiguration configuration = load_rig(rig.path, {}).configuration;
      const auto found = configuration.devices.find(device);
      if (found != configuration.devices.end()) {
        return std::string(found->second.type());
      }
    } catch (const ConfigurationError&) {
      continue;  // a rig that does not load names no device; `rigwire check` says why
    }
  }
  return {};
}

/// Something with keys that is no device: a topology of machines, a machine's or a scene's file.
int tell(const nlohmann::ordered_json& all, const std::string& what_has_keys, bool json,
         Terminal terminal) {
  if (json) {
    terminal.out << all.dump(2) << '\n';
    return static_cast<int>(ExitCode::done);
  }
  const auto text = [&](const char* key) { return all.at(key).get<std::string>(); };
  terminal.out << fmt::format("{}: {}\n\n", text("type"), text("text"));
  if (all.contains("links")) {
    terminal.out << fmt::format("links     {}\n",
                                join_words(all.at("links").get<std::vector<std::string>>()));
  }
  terminal.out << fmt::format("page      {}\n\nkeys in {}\n{}", page_file(text("page")),
                              what_has_keys, text("keys"));
  return static_cast<int>(ExitCode::done);
}

int describe_machine(const fields::Named& named, const MachineConfiguration& machine,
                     const std::string& keys, bool json, Terminal terminal) {
  const auto links = machine.model->links();
  return tell({{"type", named.name},
               {"text", named.text},
               {"page", "docs/add-a-machine.md"},
               {"links", std::vector<std::string>(links.begin(), links.end())},
               {"keys", keys}},
              "a machine file", json, terminal);
}

/// A file of configs/, read by itself. Throws ConfigurationError.
template <class Struct>
Struct load_file(const ConfigFile& file) {
  Problems problems;
  Origins origins;
  Struct loaded;
  read(load_document(file.path, problems), loaded, problems, origins);
  problems.throw_if_any();
  return loaded;
}

/// The file of that name; null when there is none.
const ConfigFile* named_file(const std::vector<ConfigFile>& files, const std::string& name) {
  const auto found = std::ranges::find(files, name, &ConfigFile::name);
  return found == files.end() ? nullptr : &*found;
}

/// The one of `names` that is chosen, or the only one there is; nothing after complaining.
std::optional<std::string> chosen(const std::string& rig, const std::string& noun,
                                  const std::string& nouns, const std::vector<std::string>& names,
                                  const std::string& choice, const std::string& option,
                                  Terminal terminal) {
  const bool known = choice.empty() || std::ranges::find(names, choice) != names.end();
  if (names.empty() || !known) {
    terminal.err << fmt::format("rigwire: {} has no {}{}{}\n", rig, noun,
                                choice.empty() ? "" : " \"" + choice + "\"",
                                names.empty() ? "" : ", allowed " + join_words(names));
    return std::nullopt;
  }
  if (choice.empty() && names.size() > 1) {
    terminal.err << fmt::format("rigwire: {} has several {}, choose one with {}: {}\n", rig, nouns,
                                option, join_words(names));
    return std::nullopt;
  }
  return choice.empty() ? names.front() : choice;
}

}  // namespace

int describe_verb(const std::string& device, bool json, Terminal terminal) {
  std::vector<std::string> names;
  const std::string of_rig = type_in_rigs(device);
  for (std::size_t row = 0; row < device_types().size(); ++row) {
    const fields::Named& type = device_types()[row].named;
    if (type.name == device || type.name == of_rig) {
      const DescribedType described = describe_type(row);
      terminal.out << (json ? json_of(described).dump(2) + "\n" : text_of(described));
      return static_cast<int>(ExitCode::done);
    }
    names.emplace_back(type.name);
  }
  for (std::size_t row = 0; row < machine_types().size(); ++row) {
    MachineConfiguration machine;
    machine.model.choose(row);
    const fields::Named& type = machine_types()[row].named;
    if (type.name == device) {
      return describe_machine(type, machine, reference_text(reference_outline(machine)), json,
                              terminal);
    }
    names.emplace_back(type.name);
  }
  const std::vector<ConfigFile> machines = config_files("machines");
  if (const ConfigFile* file = named_file(machines, device)) {
    const auto machine = load_file<MachineConfiguration>(*file);
    const std::string text = text_of(*file);
    return describe_machine({file->name, text}, machine, reference_text(outline(machine)), json,
                            terminal);
  }
  const std::vector<ConfigFile> scenes = config_files("scenes");
  const ConfigFile* file = named_file(scenes, device);
  if (file != nullptr || device == "scene") {
    const bool any = file == nullptr;
    const SceneConfiguration scene =
        any ? SceneConfiguration{} : load_file<SceneConfiguration>(*file);
    return tell({{"type", device},
                 {"text", any ? "What scenes are made of: every key there is." : text_of(*file)},
                 {"page", "docs/scenes.md"},
                 {"keys", reference_text(any ? reference_outline(scene) : outline(scene))}},
                "a scene file", json, terminal);
  }
  names.emplace_back("scene");
  for (const ConfigFile& known : machines) {
    names.push_back(known.name);
  }
  for (const ConfigFile& known : scenes) {
    names.push_back(known.name);
  }
  return refuse_word("device, machine or scene", device, names, terminal);
}

int describe_valve_map_verb(const std::string& file, Terminal terminal) {
  const emulators::ValveMap map = load_valve_map(file);
  terminal.out << fmt::format("# {}\n\n{}{}{}", map.name, map.text, map.text.empty() ? "" : "\n\n",
                              markdown_table(map));
  return static_cast<int>(ExitCode::done);
}

int describe_dbc_node_verb(const std::string& file, Terminal terminal) {
  const DbcNodeDescription device = load_dbc_node(file);
  terminal.out << fmt::format("{}{}Attached to: {}.\n\n{}", device.text,
                              device.text.empty() ? "" : "\n\n", device.attachment,
                              markdown_table(device));
  return static_cast<int>(ExitCode::done);
}

int dbc_verb(const RigArguments& arguments, const std::string& bus, const std::string& units,
             Terminal terminal) {
  const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
  const auto& buses = rig.configuration.buses;
  std::vector<std::string> names;
  for (const auto& [name, configuration] : buses) {
    names.push_back(name);
  }
  const auto name = chosen(arguments.rig, "CAN bus", "CAN buses", names, bus, "--bus", terminal);
  if (!name) {
    return static_cast<int>(ExitCode::usage);
  }
  const auto messages = bus_messages(rig.configuration, *name);
  terminal.out << protocols::dbc::write(
      {*name, buses.at(*name).bus.bit_rate_bps, messages},
      units == "sae" ? protocols::dbc::Units::document : protocols::dbc::Units::si);
  return static_cast<int>(ExitCode::done);
}

int eds_verb(const RigArguments& arguments, const std::string& device, Terminal terminal) {
  const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
  std::map<std::string, std::string> sheets;
  std::vector<std::string> names;
  for (const auto& [name, configuration] : rig.configuration.devices) {
    if (const auto eds = configuration->electronic_data_sheet()) {
      names.push_back(name);
      sheets[name] = *eds;
    }
  }
  const auto name =
      chosen(arguments.rig, "CANopen node", "CANopen nodes", names, device, "--device", terminal);
  if (!name) {
    return static_cast<int>(ExitCode::usage);
  }
  terminal.out << sheets.at(*name);
  return static_cast<int>(ExitCode::done);
}

namespace {

/// The rig's own keys, and its list of faults, which no structure of the configuration holds.
std::string schema_of_rig() {
  auto rig = nlohmann::ordered_json::parse(schema_of(RigConfiguration{}, "Rigwire: a rig"));
  auto fault = nlohmann::ordered_json::parse(schema_of(ListedFault{}, "A fault"));
  fault.erase("$schema");
  fault["additionalProperties"] = true;  // those of its kind
  rig["properties"]["faults"] = {
      {"description", "Faults of devices, buses, lines, air and machine (`rigwire list faults`)."},
      {"type", "array"},
      {"items", fault}};
  return rig.dump(2) + "\n";
}

}  // namespace

int schema_verb(const std::string& of, Terminal terminal) {
  if (of == "rig") {
    terminal.out << schema_of_rig();
  } else if (of == "machine") {
    terminal.out << schema_of(MachineConfiguration{}, "Rigwire: a machine");
  } else if (of == "scene") {
    terminal.out << schema_of(SceneConfiguration{}, "Rigwire: a scene");
  } else if (of == "valve-map") {
    terminal.out << schema_of(emulators::ValveMap{}, "Rigwire: the registers of a valve driver");
  } else if (of == "dbc-node") {
    terminal.out << schema_of(DbcNodeBinding{}, "Rigwire: the binding of a CAN device");
  } else {
    return refuse_word("kind of file", of,
                       {"rig", "machine", "scene", "valve-map", "dbc-node", "campaign"}, terminal);
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace rigwire::hil
