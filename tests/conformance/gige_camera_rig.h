// A rig of cameras on GigE Vision, run as users run it, at addresses that no other test has.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire::conformance {

using test::own_address;

/// Runs while it lives.
class GigeCameraRig {
 public:
  /// `devices`: YAML of the rig's devices, indented by two. `options`: further ones of `run`.
  explicit GigeCameraRig(const std::string& devices, const std::vector<std::string>& options = {}) {
    const auto file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR
                           "/configs/machines/gator_855d.yaml}\n"
                           "scene:\n"
                           "  terrain: {type: level, size: 60 m, cell: 1 m}\n"
                           "  boxes:\n"
                           "    - {position: [8 m, 1 m, 0 m], size: [2 m, 3 m, 2 m], "
                           "material: {label: rock}}\n"
                           "    - {position: [15 m, -4 m, 0 m], size: [4 m, 4 m, 5 m]}\n"
                           "devices:\n"
                        << devices;
    std::vector<std::string> command{RIGWIRE_BINARY_DIR "/rigwire",
                                     "run",
                                     file.string(),
                                     "--status",
                                     "none",
                                     "--report",
                                     (wires.folder / "report.json").string()};
    command.insert(command.end(), options.begin(), options.end());
    process.emplace(command, wires.folder / "rigwire.log");
  }

  /// Ends it and returns its report.
  std::string report() {
    process->signal(SIGINT);
    EXPECT_TRUE(process->wait()) << process->output();
    std::ifstream file(wires.folder / "report.json");
    return {std::istreambuf_iterator<char>(file), {}};
  }

  test::PrivateWires wires;
  std::optional<test::ChildProcess> process;
};

/// YAML of one camera; `more` are further keys, indented by four.
inline std::string camera_yaml(const std::string& name, const std::string& type,
                               const std::string& address, const std::string& more = "") {
  return "  " + name + ":\n    type: " + type + "\n    address: " + address +
         "\n    serial: " + name.substr(0, 6) + std::to_string(::getpid() % 100000) +
         "\n    mount: {link: body, position: [1.5 m, 0 m, 1.9 m], rotation: {roll: 0 deg, pitch: "
         "8 deg, yaw: 0 deg}}\n" +
         more;
}

}  // namespace rigwire::conformance
