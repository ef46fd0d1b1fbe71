// The inertial words of a position packet: what the HDL-32E's three gyroscopes, accelerometer pairs
// and thermometers read.
#pragma once

#include <array>

#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/position_packet.h"
#include "sim/samples/imu_sample.h"

namespace rigwire::emulators {

using InertialWords =
    std::array<protocols::velodyne::InertialGroup, protocols::velodyne::kInertialGroups>;

/// The sample is expressed in the sensor's frame. Readings stop at 200 deg/s and 2.5 g, the span of
/// the manual (63-9113 Rev. H, "Position packet"); what is not a number reads 0.
[[nodiscard]] InertialWords inertial_words(
    const ImuSample& sample,
    const std::array<VelodyneInertialAxes, protocols::velodyne::kInertialGroups>& axes);

}  // namespace rigwire::emulators
