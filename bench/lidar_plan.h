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

/// Returns the plan of a device with these settings.
[[nodiscard]] FiringPlan firing_plan(const emulators::VelodyneSettings& settings);

/// Returns the CPU time, ns, of a device with these settings for one firing: packets are assembled
/// and encoded, but not sent. Mean over all of `firings`, which follow each other, repeated for 40
/// ms.
[[nodiscard]] double encoding_ns_per_firing(const emulators::VelodyneSettings& settings,
                                            std::span<const LidarFiring> firings);

}  // namespace rigwire::bench
