// How the parts of a rig go together. Nothing here repeats what a single field's range says; what
// concerns one device is in its own room.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "fields/units.h"
#include "hil/devices/rig_check.h"
#include "hil/files/mesh_file.h"
#include "hil/rig/rig_configuration.h"
#include "sim/scene/mesh_repair.h"

namespace rigwire::hil {

namespace {

class Checker {
 public:
  Checker(const RigConfiguration& rig, const Origins& origins, Problems& problems)
      : rig_(rig),
        known_(problems.sorted()),
        view_(view_of(rig)),
        check_(view_, origins, problems) {}

  void run() {
    check_time();
    check_machine();
    check_parts();
    check_meshes();
    for (const auto& [name, bus] : rig_.buses) {
      if (!faulty("buses." + name)) {
        check_bus(name, bus);
      }
    }
    for (const auto& [name, line] : rig_.modbus) {
      if (!faulty("modbus." + name)) {
        check_modbus_line("modbus." + name, line);
      }
    }
    for (const auto& [name, device] : rig_.devices) {
      const std::string path = "devices." + name;
      if (!faulty(path)) {
        device->check(path, check_);
      }
    }
    for (const auto& [name, bus] : rig_.buses) {
      check_load(name, bus);
    }
    const std::vector<std::string> cameras = camera_names(rig_);
    for (std::size_t i = 0; i < rig_.truth.cameras.size(); ++i) {
      check_.one_of(fmt::format("truth.cameras.{}", i), "no such camera", rig_.truth.cameras[i],
                    cameras);
    }
  }

 private:
  /// Returns whether a member below `path` was not read and has a default that was not asked for.
  [[nodiscard]] bool faulty(const std::string& path) const {
    return std::any_of(known_.begin(), known_.end(), [&](const Problem& problem) {
      return problem.path == path || problem.path.starts_with(path + ".");
    });
  }

  void check_time() {
    if (faulty("lead") || faulty("step") || faulty("slice")) {
      return;
    }
    if (rig_.slice % rig_.step != Duration{0}) {
      check_.report("slice", "must be a whole number of steps",
                    fields::print_duration(rig_.slice.count()),
                    "multiples of step = " + fields::print_duration(rig_.step.count()));
    }
    if (rig_.lead < rig_.slice) {
      check_.report("lead", "must not be less than a slice",
                    fields::print_duration(rig_.lead.count()),
                    ">= " + fields::print_duration(rig_.slice.count()));
    }
  }

  void check_machine() {
    const MachineConfiguration& machine = rig_.machine;
    for (std::size_t i = 0; i < machine.shapes.size(); ++i) {
      check_.link(fmt::format("machine.shapes.{}.link", i), machine.shapes[i].link);
    }
    if (machine.model->drives() && !faulty("machine.position") && machine.position_m.z != 0.0) {
      check_.report("machine.position.2", "the machine is placed on the terrain automatically",
                    fields::shortest(machine.position_m.z) + " m", "0 m");
    }
    if (machine.model->drives() && !machine.on_ground) {
      check_.report("machine.on_ground", "the machine is placed on the terrain automatically",
                    "false", "true");
    }
  }

  /// What fails, the machine has.
  void check_parts() {
    const MachineModel& model = *rig_.machine.model;
    const bool moves = rig_.machine.motion.file.empty();
    const auto check = [&](std::string_view key, const auto& faults, bool has, const char* what) {
      if (!(has && moves) && !faults.empty()) {
        check_.report(fmt::format("{}.{}.faults.0.type", kSurroundings, key), what,
                      std::string(fields::chosen_name(faults.front().what)),
                      "with a machine that has, and that moves by itself");
      }
    };
    check("engine", rig_.surroundings.engine.faults, model.has_engine(),
          "the machine has no engine by which it moves");
    check("pumps", rig_.surroundings.pumps.faults, model.has_power_unit(),
          "the machine has no engine that drives pumps");
  }

  /// Checks that every file of triangles can be read and has a size that rays in the scene can hit.
  void check_meshes() {
    if (!faulty("machine")) {
      for (std::size_t i = 0; i < rig_.machine.shapes.size(); ++i) {
        const std::string path = fmt::format("machine.shapes.{}", i);
        if (const auto* mesh = std::get_if<MeshShape>(&rig_.machine.shapes[i].placed.shape)) {
          check_mesh(path, ".file", mesh->scale,
                     [&](double& reach) { include(load_mesh(mesh->file, path), reach); });
        }
      }
    }
    if (!faulty("scene")) {
      const auto& objects = rig_.scene.description.objects;
      for (std::size_t i = 0; i < objects.size(); ++i) {
        const std::string path = fmt::format("scene.objects.{}", i);
        check_mesh(path, ".mesh", objects[i].scale, [&](double& reach) {
          for (const sim::TriangleMesh& part : load_model(objects[i].mesh, path).parts) {
            include(part, reach);
          }
        });
      }
    }
  }

  static void include(const sim::TriangleMesh& mesh, double& reach) {
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      reach = std::max(reach, vertex.cast<double>().norm());
    }
  }

  /// `load` raises `reach` to the farthest vertex from the mesh's origin, in the file's unit.
  template <class Load>
  void check_mesh(const std::string& path, const std::string& file, double scale, Load&& load) {
    constexpr double kLeastReach_m = 1e-3;
    double reach = 0.0;
    try {
      load(reach);
    } catch (const std::invalid_argument& error) {
      check_.report(path + file, error.what());
      return;
    }
    if (reach * scale < kLeastReach_m || reach * scale > sim::kFarthestVertex_m) {
      check_.report(
          path + ".scale", fmt::format("the mesh reaches {:.3g} m from its origin", reach * scale),
          fields::shortest(scale),
          fmt::format("{:.3g} .. {:.3g}", kLeastReach_m / reach, sim::kFarthestVertex_m / reach));
    }
  }

  void check_bus(const std::string& name, const BusConfiguration& bus) {
    const std::string path = "buses." + name;
    if (bus.wire == CanWire::gs_usb) {
      check_.usb();
    }
    if (bus.wire == CanWire::slcan || bus.wire == CanWire::automatic) {
      check_.port_paths(path, bus.path, bus.ports);
    }
    if (bus.wire == CanWire::socketcan || bus.wire == CanWire::automatic) {
      constexpr std::size_t kLongestInterface = 15;  // IFNAMSIZ - 1
      if (bus.interface.empty() || bus.interface.size() > kLongestInterface) {
        check_.report(path + ".interface", "not an interface name", "\"" + bus.interface + "\"",
                      "1 .. 15 characters");
      }
      check_.claim(path + ".interface", "interface " + bus.interface, bus.interface);
    }
    if (bus.socketcand.port != 0) {
      check_.listener(path + ".socketcand", bus.socketcand.address, bus.socketcand.port,
                      bus.socketcand.allow_remote);
    }
    const std::vector<std::string> devices = devices_on(name);
    const std::vector<std::string> clients = client_nodes(bus);
    for (const std::string& device : devices) {
      if (std::ranges::find(clients, device) != clients.end()) {
        check_.report("devices." + device, "the name of a client's node on its bus", "",
                      "any other name");
      }
    }
    std::vector<std::string> nodes = devices;
    std::ranges::copy(clients, std::back_inserter(nodes));
    for (std::size_t i = 0; i < bus.faults.size(); ++i) {
      if (const std::string node = emulators::node_of(bus.faults[i]); !node.empty()) {
        check_.one_of(fmt::format("{}.faults.{}.device", path, i), "not on this bus", node, nodes);
      }
    }
  }

  /// Returns the bus's possible client nodes. The wire that `auto` takes is known when the rig
  /// runs; a port that does not exist then is refused.
  static std::vector<std::string> client_nodes(const BusConfiguration& bus) {
    std::vector<std::string> names;
    for (unsigned port = 0; port < bus.ports; ++port) {
      names.push_back(client_node(port));
    }
    if (bus.socketcand.port != 0) {
      names.emplace_back(kSocketcandNode);
    }
    return names;
  }

  /// Those that are refused make no device, and have no place on a bus to ask for.
  [[nodiscard]] std::vector<std::string> devices_on(const std::string& bus) const {
    std::vector<std::string> names;
    for (const auto& [name, device] : rig_.devices) {
      if (faulty("devices." + name)) {
        continue;
      }
      const auto share = device->bus_share(name);
      if (share && share->bus == bus) {
        names.push_back(name);
      }
    }
    return names;
  }

  void check_modbus_line(const std::string& path, const ModbusLineConfiguration& line) {
    if (line.wire == emulators::ModbusWire::rtu) {
      check_.file_path(path + ".path", line.path);
    } else {
      check_.listener(path, line.address, line.port, line.allow_remote);
    }
  }

  /// Frames of data per second against the bit rate.
  void check_load(const std::string& name, const BusConfiguration& bus) {
    // Extended data frame with 8 bytes: 67 bits of frame and interframe space around 64 bits of
    // data, and at worst one stuff bit for every four of the 118 bits that are stuffed.
    constexpr int kStuffBits = 118 / 4;
    constexpr double kBitsPerFrame = 67 + 64 + kStuffBits;
    double frames = 0.0;
    for (const auto& [device_name, device] : rig_.devices) {
      if (faulty("devices." + device_name)) {
        continue;
      }
      const auto share = device->bus_share(device_name);
      if (share && share->bus == name) {
        frames += share->frames_hz;
      }
    }
    const double needed = frames * kBitsPerFrame;
    if (needed > static_cast<double>(bus.bus.bit_rate_bps)) {
      check_.report("buses." + name + ".bitrate",
                    fmt::format("the devices of this bus send up to {:.0f} frames/s, {:.0f} bit/s",
                                frames, needed),
                    fmt::format("{} bit/s", bus.bus.bit_rate_bps),
                    fmt::format(">= {:.0f} bit/s, or a lower rate of the devices", needed));
    }
  }

  const RigConfiguration& rig_;
  std::vector<Problem> known_;  ///< Found while reading.
  RigView view_;
  RigCheck check_;
};

}  // namespace

void check_rig(const RigConfiguration& configuration, const Origins& origins, Problems& problems) {
  Checker(configuration, origins, problems).run();
}

}  // namespace rigwire::hil
