// `rigwire describe --dbc`: the DBC file of a rig's bus.
#include "protocols/dbc/dbc_writer.h"

#include <fmt/format.h>

#include "hil/command_line/config_files.h"
#include "hil/command_line/verbs.h"
#include "hil/configuration/suggest.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

int dbc_verb(const RigArguments& arguments, const std::string& bus, const std::string& units,
             Terminal terminal) {
  const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
  const auto& buses = rig.configuration.buses;
  std::vector<std::string> names;
  for (const auto& [name, configuration] : buses) {
    names.push_back(name);
  }
  if (names.empty() || (!bus.empty() && !buses.contains(bus))) {
    terminal.err << fmt::format("rigwire: {} has no CAN bus{}{}\n", arguments.rig,
                                bus.empty() ? "" : " \"" + bus + "\"",
                                names.empty() ? "" : ", allowed " + join_words(names));
    return static_cast<int>(ExitCode::usage);
  }
  if (bus.empty() && names.size() > 1) {
    terminal.err << fmt::format("rigwire: {} has several CAN buses, choose one with --bus: {}\n",
                                arguments.rig, join_words(names));
    return static_cast<int>(ExitCode::usage);
  }
  const std::string& name = bus.empty() ? names.front() : bus;
  const auto messages = bus_messages(rig.configuration, name);
  terminal.out << protocols::dbc::write(
      {name, buses.at(name).bus.bit_rate_bps, messages},
      units == "sae" ? protocols::dbc::Units::document : protocols::dbc::Units::si);
  return static_cast<int>(ExitCode::done);
}

}  // namespace rigwire::hil
