// `rigwire describe --eds`: the electronic data sheet of a rig's CANopen node.
#include <fmt/format.h>

#include <algorithm>

#include "hil/command_line/config_files.h"
#include "hil/command_line/verbs.h"
#include "hil/configuration/suggest.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

int eds_verb(const RigArguments& arguments, const std::string& device, Terminal terminal) {
  const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
  std::vector<std::string> names;
  std::string sheet;
  for (const auto& [name, configuration] : rig.configuration.devices) {
    if (const auto eds = configuration->electronic_data_sheet()) {
      names.push_back(name);
      sheet = device.empty() || name == device ? *eds : sheet;
    }
  }
  const bool known = device.empty() || std::ranges::find(names, device) != names.end();
  if (names.empty() || !known) {
    terminal.err << fmt::format("rigwire: {} has no CANopen node{}{}\n", arguments.rig,
                                device.empty() ? "" : " \"" + device + "\"",
                                names.empty() ? "" : ", allowed " + join_words(names));
    return static_cast<int>(ExitCode::usage);
  }
  if (device.empty() && names.size() > 1) {
    terminal.err << fmt::format(
        "rigwire: {} has several CANopen nodes, choose one with --device: "
        "{}\n",
        arguments.rig, join_words(names));
    return static_cast<int>(ExitCode::usage);
  }
  terminal.out << sheet;
  return static_cast<int>(ExitCode::done);
}

}  // namespace rigwire::hil
