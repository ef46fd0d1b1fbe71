// A StarFire 3000 of a rig: one antenna, a serial line, a node of a CAN bus, or both.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emulators/starfire/settings.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device_configuration.h"
#include "hil/wires/line_ports.h"
#include "hil/world/shapes.h"
#include "sim/gnss/gnss_sensor.h"

namespace rigwire::hil {

/// John Deere StarFire 3000.
struct StarFireConfiguration final : DeviceConfigurationOf<StarFireConfiguration> {
  /// Symbolic link to the pty; empty = no serial line.
  std::string path = "/tmp/rigwire/starfire";
  /// Number of ptys: all receive from the device, which receives from the first.
  unsigned ports = 1;
  BaudCheck check_baud = BaudCheck::lenient;
  std::string bus;           ///< One of the rig's buses; empty = no node.
  MountConfiguration mount;  ///< Mount of the antenna.
  emulators::StarFireSettings receiver;
  sim::GnssParameters sensor;
  std::vector<MixedFault<sim::GnssFault, emulators::SupplyFault>> faults;

  StarFireConfiguration();

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
  [[nodiscard]] bool is_receiver() const override { return true; }
};

}  // namespace rigwire::hil
