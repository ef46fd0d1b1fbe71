#include "hil/rig/rig_configuration.h"

#include <iterator>

#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/files/file_content.h"
#include "hil/rig/fault_list.h"

namespace rigwire::hil {

LoadedRig load_rig(const std::string& file, const std::vector<std::string>& sets) {
  Problems problems;
  Value document = load_document(file, problems);
  for (const std::string& set : sets) {
    apply_set(document, set, problems);
  }
  LoadedRig rig;
  bring_faults_home(document, problems, rig.origins);
  // A file that cannot be read at all would only be followed by complaints about missing keys.
  if (problems.empty() || !document.entries.empty()) {
    read(document, rig.configuration, problems, rig.origins);
  }
  check_rig(rig.configuration, rig.origins, problems);
  problems.name_as_written(rig.origins);
  problems.throw_if_any();
  return rig;
}

std::string config_hash(const RigConfiguration& configuration) {
  return hash_text(outline(configuration), file_content);
}

std::string print_rig(const LoadedRig& rig) {
  return print_yaml(outline(rig.configuration), rig.origins);
}

std::string print_rig(const RigConfiguration& configuration) {
  return print_yaml(outline(configuration), {});
}

std::vector<std::string> camera_names(const RigConfiguration& configuration) {
  std::vector<std::string> names;
  for (const auto& [name, device] : configuration.devices) {
    if (device->is_camera()) {
      names.push_back(name);
    }
  }
  return names;
}

RigView view_of(const RigConfiguration& configuration) {
  const MachineModel& machine = *configuration.machine.model;
  const std::vector<std::string_view> actuators = machine.actuators();
  RigView view{configuration.buses,
               configuration.modbus,
               configuration.usb,
               {machine.links().begin(), machine.links().end()},
               {actuators.begin(), actuators.end()},
               machine.drives(),
               machine.has_power_unit(),
               {},
               {}};
  for (const auto& [name, device] : configuration.devices) {
    if (device->is_receiver()) {
      view.receivers.push_back(name);
    }
    if (device->is_base_station()) {
      view.base_stations.push_back(name);
    }
  }
  return view;
}

void each_fault(RigConfiguration& configuration,
                const std::function<void(const std::string& where, FaultPeriod& when,
                                         const std::string& name)>& take) {
  const auto of = [&take](std::string where) {
    return [&take, where = std::move(where)](FaultPeriod& when, const std::string& name) {
      take(where, when, name);
    };
  };
  for (auto& [name, device] : configuration.devices) {
    device->each_fault(of(name));
  }
  for (auto& [name, bus] : configuration.buses) {
    show_faults(bus.faults, of("bus " + name), can_fault_name);
  }
  for (auto& [name, line] : configuration.modbus) {
    show_faults(line.faults, of("modbus " + name));
  }
  SurroundingsConfiguration& around = configuration.surroundings;
  const auto name_of = [](std::size_t target) {
    return std::string(kSurroundingsTargets[target].name);
  };
  show_faults(around.air.faults, of(name_of(0)));
  show_faults(around.engine.faults, of(name_of(1)));
  show_faults(around.pumps.faults, of(name_of(2)));
}

std::vector<FaultWindow> fault_windows(const RigConfiguration& configuration) {
  std::vector<FaultWindow> all;
  RigConfiguration copy = configuration;
  each_fault(copy, [&](const std::string& where, FaultPeriod& when, const std::string& name) {
    all.push_back(fault_window(where, name, when));
  });
  return all;
}

std::vector<protocols::can::OwnedMessage> bus_messages(const RigConfiguration& configuration,
                                                       const std::string& bus) {
  std::vector<protocols::can::OwnedMessage> all;
  for (const auto& [name, device] : configuration.devices) {
    auto share = device->bus_share(name);
    if (share && share->bus == bus) {
      all.insert(all.end(), std::move_iterator(share->messages.begin()),
                 std::move_iterator(share->messages.end()));
    }
  }
  return all;
}

}  // namespace rigwire::hil
