// A CANopen inclinometer: bus, mount, what it is at delivery and the sensor in it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "emulators/canopen/inclinometer.h"
#include "emulators/own_clock.h"
#include "hil/devices/device_configuration.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"

namespace rigwire::hil {

/// Two-axis inclinometer (CANopen, CiA 410) on a link of the machine.
struct InclinometerConfiguration final : DeviceConfigurationOf<InclinometerConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  MountConfiguration mount;
  emulators::InclinometerSettings inclinometer;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
  sim::ImuParameters sensor;  ///< Its accelerometer; the gyroscope is not used.

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  [[nodiscard]] std::vector<FaultWindow> fault_windows(std::string_view name) const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
  [[nodiscard]] std::optional<std::string> electronic_data_sheet() const override;
};

}  // namespace rigwire::hil
