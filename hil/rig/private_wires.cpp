#include "hil/rig/private_wires.h"

#include <fmt/format.h>

#include "hil/devices/velodyne.h"
#include "hil/rig/isolated_rig.h"

namespace rigwire::hil {

RigConfiguration made_private(const RigConfiguration& recorded, const std::filesystem::path& folder,
                              drivers::LoopbackClaims& claims, std::vector<std::string>& remarks) {
  std::vector<Replacement> replacements =
      isolating(recorded, {}, folder, claims, RemoteAddresses::kept);
  for (const std::string& camera : camera_names(recorded)) {
    std::erase_if(replacements, [&](const Replacement& replacement) {
      return replacement.key == "devices." + camera + ".address";
    });
  }
  RigConfiguration rig = with(recorded, replacements);
  for (auto& [name, bus] : rig.buses) {
    if (bus.ports != 1 || bus.socketcand.port != 0) {
      remarks.push_back(
          fmt::format("bus {}: frames that clients sent at further ports (ports, socketcand) count "
                      "as the devices' "
                      "and are not replayed",
                      name));
    }
    bus.ports = 1;
    bus.socketcand.port = 0;
    bus.attach = false;
  }
  for (auto& [name, device] : rig.devices) {
    if (auto* lidar = dynamic_cast<VelodyneConfiguration*>(&*device)) {
      if (lidar->web.port != 0) {
        remarks.push_back(name + ": its web interface is not recorded, and not asked again");
      }
      lidar->web.port = 0;
      lidar->source_ports = SourcePorts::any;
    } else if (device.type() == "ntrip-caster") {
      remarks.push_back(name + ": clients of a caster are not recorded, and do not come again");
    }
  }
  rig.truth.path.clear();
  rig.truth.lidar_path.clear();
  rig.truth.camera_folder.clear();
  return rig;
}

}  // namespace rigwire::hil
