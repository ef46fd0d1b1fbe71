// What a lidar's device asks of the caster, for benchmarks without a rig.
#pragma once

#include <span>

#include "emulators/velodyne/velodyne_lidar.h"
#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"

namespace rigwire::bench {

struct FiringPlan {
  LidarPattern pattern;
  SamplePlan plan;
  LidarCommand command;
};

/// Of a device with these settings.
[[nodiscard]] FiringPlan firing_plan(const emulators::VelodyneSettings& settings);

/// Nanoseconds of CPU time that the device with these settings needs for a firing: packets
/// assembled and laid out, sent to nobody. The mean over all of `firings`, which follow each other,
/// taken over and over for 40 ms.
[[nodiscard]] double encoding_ns_per_firing(const emulators::VelodyneSettings& settings,
                                            std::span<const LidarFiring> firings);

}  // namespace rigwire::bench
