// Sensors that several types of devices carry, put on the machine for the station of a device.
#pragma once

#include <vector>

#include "hil/devices/site.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// A satellite antenna, with what happens to its signals.
void mount_antenna(Site& site, StationIndex station, const MountConfiguration& mount,
                   const sim::GnssParameters& sensor, const std::vector<sim::GnssFault>& faults);

/// An inertial unit, with its magnetometer where it has one.
void mount_inertial_unit(Site& site, StationIndex station, const MountConfiguration& mount,
                         const sim::ImuParameters& sensor,
                         const sim::MagnetometerConfiguration& magnetometer);

}  // namespace rigwire::hil
