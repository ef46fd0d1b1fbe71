// Xsens MTi-600: bus, mount, messages with their rates, and sensor.
#pragma once

#include <string>

#include "emulators/xsens/mti_600.h"
#include "fields/visitor.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// Xsens MTi-600 on a CAN bus.
struct XsensMtiConfiguration {
  static constexpr fields::Named kNamed{"xsens-mti-600", "Xsens MTi-600 inertial unit on CAN."};

  std::string bus = "can";  ///< One of the rig's buses.
  MountConfiguration mount;
  emulators::MtiSettings mti;
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;
};

inline void visit(fields::Visitor& v, XsensMtiConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  visit(v, p.mti);
  v.section("mount", p.mount, "Of the sensor's axes.");
  v.section("sensor", p.sensor, "How well it measures.");
  v.section("magnetometer", p.magnetometer, "The Earth's field as it reads it.");
}

inline void validate(const XsensMtiConfiguration& p) {
  validate(p.mti);
}

}  // namespace rigwire::hil
