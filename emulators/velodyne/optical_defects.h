// What a defective head sees: dead lasers, dirt on the window.
//
// Dirt takes light twice, on the way out and back: with transmission T an echo of reflectivity rho
// at range r is still found when
//
//   rho T^2 / r^2 >= 0.9 / R^2
//
// where R is the range at which the sensor just finds a white surface of 90 % (Goodin et al.,
// Electronics 8(1):89, 2019, eq. for the least detectable power). Its reflectivity is reported as
// rho T^2, because the sensor makes up for range but does not know of the dirt; of a
// retro-reflector only the part above 1 is scaled.
#pragma once

#include "emulators/velodyne/velodyne_fault.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::emulators {

/// Applies what of the faults holds at the bank's time. `reference_range_m` is R.
void apply_optical_defects(const VelodyneFaults& faults, const LidarPattern& pattern,
                           double reference_range_m, LidarFiring& bank);

}  // namespace rigwire::emulators
