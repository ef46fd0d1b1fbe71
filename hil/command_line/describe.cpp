#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "fields/visitor.h"
#include "hil/command_line/config_files.h"
#include "hil/command_line/verbs.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/suggest.h"
#include "hil/devices/device_types.h"
#include "hil/files/valve_map_file.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

namespace {

/// A device type with its defaults, as it is told.
struct DescribedType {
  fields::Named named;
  DeviceDescription description;
  std::string keys;  ///< Reference of the configuration keys.
};

DescribedType describe_type(std::size_t row) {
  const DeviceType& type = device_types()[row];
  const ConfiguredDevice device(row);
  DescribedType described{type.named, device->describe(), reference_text(outline(device))};
  if (described.description.page.empty()) {
    described.description.page = fmt::format("docs/devices/{}.md", type.named.name);
  }
  return described;
}

std::string text_of(const DescribedType& type) {
  const DeviceDescription& description = type.description;
  std::string text =
      fmt::format("{}: {}\n\nwire      {}\nfollows   {}\npage      {}\n", type.named.name,
                  type.named.text, description.wire, description.document, description.page);
  std::vector<std::vector<std::string>> rows{{"message", "rate", "content"}};
  for (const DeviceMessage& message : description.messages) {
    rows.push_back({message.name, message.rate, message.content});
  }
  text += "\n" + table_text(rows);
  if (!description.quantities.empty()) {
    rows = {{"quantity", "unit", "from", "to", "resolution"}};
    for (const DescribedQuantity& quantity : description.quantities) {
      rows.push_back({quantity.name, quantity.unit, fmt::format("{:.6g}", quantity.lower),
                      fmt::format("{:.6g}", quantity.upper),
                      fmt::format("{:.6g}", quantity.resolution)});
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
                              {"messages", nlohmann::ordered_json::array()},
                              {"quantities", nlohmann::ordered_json::array()}};
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

/// The type of a device that one of the rigs at hand calls by that name; empty when none does.
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

/// A topology of machines: what devices and shapes are mounted on, and its keys.
struct MachineDescription {
  fields::Named type;
  std::vector<std::string> links;
  std::string keys;
};

std::vector<MachineDescription> machine_catalogue() {
  std::vector<MachineDescription> list;
  for (std::size_t row = 0; row < machine_types().size(); ++row) {
    MachineConfiguration machine;
    machine.model.choose(row);
    const auto links = machine.model->links();
    list.push_back({machine_types()[row].named,
                    {links.begin(), links.end()},
                    reference_text(outline(machine))});
  }
  return list;
}

int describe_machine(const MachineDescription& machine, bool json, Terminal terminal) {
  if (json) {
    const nlohmann::ordered_json all{{"type", machine.type.name},
                                     {"text", machine.type.text},
                                     {"page", "docs/add-a-machine.md"},
                                     {"links", machine.links},
                                     {"keys", machine.keys}};
    terminal.out << all.dump(2) << '\n';
  } else {
    terminal.out << fmt::format(
        "{}: {}\n\nlinks     {}\npage      docs/add-a-machine.md\n\nkeys in a machine file\n{}",
        machine.type.name, machine.type.text, join_words(machine.links), machine.keys);
  }
  return static_cast<int>(ExitCode::done);
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
  for (const MachineDescription& machine : machine_catalogue()) {
    if (machine.type.name == device) {
      return describe_machine(machine, json, terminal);
    }
    names.emplace_back(machine.type.name);
  }
  const std::string near = nearest_word(device, names);
  terminal.err << fmt::format("rigwire: unknown device or machine, found \"{}\", allowed {}{}\n",
                              device, join_words(names),
                              near.empty() ? "" : ", did you mean " + near + "?");
  return static_cast<int>(ExitCode::usage);
}

int describe_valve_map_verb(const std::string& file, Terminal terminal) {
  const emulators::ValveMap map = load_valve_map(file);
  terminal.out << fmt::format("# {}\n\n{}{}{}", map.name, map.text, map.text.empty() ? "" : "\n\n",
                              markdown_table(map));
  return static_cast<int>(ExitCode::done);
}

}  // namespace rigwire::hil
