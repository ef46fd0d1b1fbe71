// A u-blox receiver of a rig: its line, its antenna, its behaviour and its accuracy.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emulators/ublox/settings.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device_configuration.h"
#include "hil/wires/line_ports.h"
#include "hil/wires/usb_configuration.h"
#include "hil/world/shapes.h"
#include "sim/gnss/gnss_sensor.h"

namespace rigwire::hil {

enum class SerialWire { pty, usb };

/// The types of receivers differ in their profile, and by default in the systems that they receive.
struct UbloxConfiguration final : DeviceConfigurationOf<UbloxConfiguration> {
  SerialWire wire = SerialWire::pty;
  std::string path = "/tmp/rigwire/gnss";  ///< Symbolic link to the pty that a client opens.
  /// Number of ptys: all receive from the device, which receives from the first.
  unsigned ports = 1;
  BaudCheck check_baud = BaudCheck::lenient;
  MountConfiguration mount;  ///< Mount of the antenna.
  emulators::UbloxSettings receiver;
  sim::GnssParameters sensor;
  std::vector<MixedFault<PlugFault, sim::GnssFault, emulators::UbloxFault, emulators::SupplyFault>>
      faults;
  /// The base station whose corrections its second UART receives; empty: none.
  std::string corrections_from;

  explicit UbloxConfiguration(const emulators::UbloxProfile& profile = emulators::ublox_neo_7p());

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] std::vector<LiveKey> live_keys() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
  [[nodiscard]] bool is_receiver() const override { return true; }
  [[nodiscard]] bool is_base_station() const override { return receiver.profile->carrier_solution; }
};

}  // namespace rigwire::hil
