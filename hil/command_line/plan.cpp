// What a rig will do, from its configuration alone.
#include "hil/command_line/verbs.h"
#include "hil/devices/site.h"

namespace rigwire::hil {

std::string plan_text(const RigConfiguration& configuration) {
  const RigView rig = view_of(configuration);
  std::vector<std::vector<std::string>> rows{{"device", "type", "wire", "sends", "bytes", "with"}};
  for (const auto& [name, device] : configuration.devices) {
    const DevicePlan plan = device->plan(rig);
    rows.push_back(
        {name, std::string(device.type()), plan.wire, plan.sends, plan.bytes, plan.with});
  }
  return table_text(rows);
}

}  // namespace rigwire::hil
