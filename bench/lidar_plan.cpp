#include "bench/lidar_plan.h"

#include "emulators/device.h"
#include "hil/executive/cpu_time.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::bench {

FiringPlan firing_plan(const emulators::VelodyneSettings& settings) {
  const Calendar calendar(hil::RigConfiguration{}.start);
  emulators::NullByteOutput silence;
  const emulators::VelodyneLidar device(settings, calendar, silence, silence);
  return {device.pattern(), device.sample_plan(), device.command()};
}

double encoding_ns_per_firing(const emulators::VelodyneSettings& settings,
                              std::span<const LidarFiring> firings) {
  constexpr double kSpan_s = 0.04;
  const Calendar calendar(hil::RigConfiguration{}.start);
  emulators::NullByteOutput silence;
  emulators::VelodyneLidar device(settings, calendar, silence, silence);
  double spent_s = 0.0;
  std::size_t count = 0;
  while (spent_s < kSpan_s) {
    const double begin_s = hil::thread_cpu_seconds();
    for (const LidarFiring& firing : firings) {
      device.update(firing);
    }
    spent_s += hil::thread_cpu_seconds() - begin_s;
    count += firings.size();
  }
  return 1e9 * spent_s / static_cast<double>(count);
}

}  // namespace rigwire::bench
