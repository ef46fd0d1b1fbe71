// The controller of an engine with pumps in a rig: its bus and its node.
#pragma once

#include <memory>
#include <string>

#include "emulators/engine_controller/engine_controller.h"
#include "emulators/own_clock.h"
#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

/// J1939 node of an engine that drives hydraulic pumps.
struct EngineControllerConfiguration final : DeviceConfigurationOf<EngineControllerConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  emulators::EngineControllerSettings engine;

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
