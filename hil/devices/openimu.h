// ACEINNA OpenIMU: bus, mount, device and sensor.
#pragma once

#include <memory>
#include <string>

#include "emulators/openimu/openimu335ri.h"
#include "emulators/own_clock.h"
#include "hil/devices/device_configuration.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// ACEINNA OpenIMU335RI on a J1939 bus, or OpenIMU300RI: the same with older firmware and a
/// magnetometer.
struct OpenImuDeviceConfiguration final : DeviceConfigurationOf<OpenImuDeviceConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  MountConfiguration mount;
  emulators::OpenImuSettings imu;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;  ///< OpenIMU300RI.

  explicit OpenImuDeviceConfiguration(
      emulators::OpenImuVariant variant = emulators::OpenImuVariant::openimu335ri) {
    imu.variant = variant;
  }

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
