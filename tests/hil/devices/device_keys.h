// A rig of one device on a wheeled machine, for tests of the device's keys.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <utility>

#include "fields/chosen.h"
#include "hil/rig/rig_configuration.h"
#include "private_wires.h"

namespace rigwire::hil {

class DeviceKeys : public ::testing::Test {
 protected:
  explicit DeviceKeys(std::string name) : name_(std::move(name)) {}

  /// `keys`: of the device, indented by four; `devices`: YAML of further ones, indented by two.
  void write(const std::string& type, const std::string& keys, const std::string& devices = "") {
    std::ofstream(file) << "machine: {type: wheeled}\ndevices:\n  " << name_
                        << ":\n    type: " << type << "\n    mount: {link: body}\n"
                        << keys << devices;
  }
  /// What is wrong with it; empty: nothing.
  std::string complaints() {
    try {
      (void)load_rig(file, {});
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  /// What the emulator is told.
  template <class Configuration>
  auto settings_from() {
    const LoadedRig loaded = load_rig(file, {});
    return settings_of(*fields::as<Configuration>(loaded.configuration.devices.at(name_)));
  }

  rigwire::test::PrivateWires wires;
  std::string file = (wires.folder / "rig.yaml").string();

 private:
  std::string name_;
};

}  // namespace rigwire::hil
