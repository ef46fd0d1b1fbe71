// The vehicle gateway of a rig: its bus, its node, what it knows of its machine, how long it waits
// for commands, and the machine's own sensors and odometry that it reports.
#pragma once

#include <memory>
#include <string>

#include "emulators/own_clock.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "hil/devices/device_configuration.h"
#include "sim/odometry/odometry.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::hil {

/// J1939 node between a field controller and a machine that drives.
struct VehicleGatewayConfiguration final : DeviceConfigurationOf<VehicleGatewayConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::string position_from;  ///< Name of the satellite receiver wired to it; empty: none.
  emulators::VehicleGatewaySettings gateway;
  sim::VehicleSensorParameters sensor;
  sim::OdometryParameters odometry;

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
