// Hydraulic valves on ISO 11783: bus, valves, levers, amplifier.
#pragma once

#include <memory>
#include <string>

#include "emulators/iso_valve/iso_valves.h"
#include "emulators/own_clock.h"
#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

/// A block of auxiliary valves on a J1939 bus.
struct IsoValvesConfiguration final : DeviceConfigurationOf<IsoValvesConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  emulators::IsoValveSettings valves;

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  [[nodiscard]] std::vector<FaultWindow> fault_windows(std::string_view name) const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
};

}  // namespace rigwire::hil
