// ACEINNA OpenIMU: wire, mount, device and sensor.
#pragma once

#include <string>

#include "emulators/openimu/openimu335ri.h"
#include "fields/visitor.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// ACEINNA OpenIMU335RI on a J1939 bus.
struct OpenImuDeviceConfiguration {
  static constexpr fields::Named kNamed{"openimu335ri",
                                        "ACEINNA OpenIMU335RI inertial unit on CAN (J1939)."};

  std::string bus = "can";  ///< One of the rig's buses.
  MountConfiguration mount;
  emulators::OpenImuSettings imu;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;  ///< OpenIMU300RI.
};

/// ACEINNA OpenIMU300RI, the same with older firmware and a magnetometer.
struct OpenImu300riDeviceConfiguration : OpenImuDeviceConfiguration {
  static constexpr fields::Named kNamed{
      "openimu300ri", "ACEINNA OpenIMU300RI inertial unit on CAN (J1939), with magnetometer."};

  OpenImu300riDeviceConfiguration() { imu.variant = emulators::OpenImuVariant::openimu300ri; }
};

inline void visit(fields::Visitor& v, OpenImuDeviceConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  visit(v, p.imu);
  v.text("settings_file", p.settings_file,
         "What a client saved, for the next run; empty: as long as the run.");
  v.section("mount", p.mount, "Of the sensor's axes.");
  v.section("sensor", p.sensor, "How well it measures.");
  if (p.imu.variant == emulators::OpenImuVariant::openimu300ri) {
    v.section("magnetometer", p.magnetometer, "The Earth's field as it reads it.");
  }
}

inline void validate(const OpenImuDeviceConfiguration& p) {
  validate(p.imu);
}

}  // namespace rigwire::hil
