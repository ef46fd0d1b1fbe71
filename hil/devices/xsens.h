// Xsens MTi-600: bus, mount, messages with their rates, and sensor.
#pragma once

#include <memory>
#include <string>

#include "emulators/own_clock.h"
#include "emulators/xsens/mti_600.h"
#include "hil/devices/device_configuration.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// Xsens MTi-600 on a CAN bus.
struct XsensMtiConfiguration final : DeviceConfigurationOf<XsensMtiConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  MountConfiguration mount;
  emulators::MtiSettings mti;
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;

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
