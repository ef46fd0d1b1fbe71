// One step, one sample or one slice of each model.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "sim/excavator/excavator.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/imu/imu_sensor.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

constexpr std::uint64_t kSeed = 1;

void excavator_step(benchmark::State& state) {
  ExcavatorParameters parameters;
  parameters.step_s = 0.5e-3;
  Excavator machine(parameters, Eigen::Isometry3d::Identity());
  ValveCommand command;
  double sign = 1.0;
  int steps = 0;
  for (auto _ : state) {
    if (steps++ % 1000 == 0) {
      sign = -sign;
      command.opening = {0.6 * sign, 0.5 * sign, -0.6 * sign, 0.7 * sign};
      machine.command(command);
    }
    machine.step(std::chrono::microseconds{500});
  }
  if (!machine.finite()) {
    state.SkipWithError("the machine's state is no number");
  }
}
BENCHMARK(excavator_step);

void imu_sample(benchmark::State& state) {
  ImuSensor sensor(ImuParameters{}, kSeed, "imu");
  LinkMotion motion;
  SimTime now = kStart;
  for (auto _ : state) {
    now += std::chrono::milliseconds{5};
    benchmark::DoNotOptimize(sensor.sample(now, motion, 9.80665));
  }
}
BENCHMARK(imu_sample);

void gnss_sample(benchmark::State& state) {
  const BuiltScene built = build_scene({}, {}, kSeed);
  const Calendar calendar({2026, 6, 1, 8, 0, 0, 0});
  const LocalFrame frame({49.4247, 7.7517, 240.0, 48.0});
  GnssSensor sensor(GnssParameters{}, calendar, frame, kSeed, "gnss");
  built.scene->begin_slice(kStart, kStart + std::chrono::milliseconds{1}, Eigen::Vector3d::Zero(),
                           {});
  LinkMotion motion;
  motion.X_WL.translation() = Eigen::Vector3d(0.0, 0.0, 3.0);
  SimTime now = kStart;
  for (auto _ : state) {
    now += std::chrono::seconds{1};
    benchmark::DoNotOptimize(sensor.sample(now, motion, *built.scene));
  }
}
BENCHMARK(gnss_sample);

/// An HDL-32E's firing, written plainly: 32 lasers, 4/3 degrees apart.
LidarPattern fan() {
  LidarPattern pattern;
  for (int j = 0; j < 32; ++j) {
    const double elevation_deg = (j % 2 == 0 ? -30.67 : -9.33) + 4.0 / 3.0 * std::floor(0.5 * j);
    pattern.lasers.push_back({.elevation_rad = elevation_deg * std::numbers::pi / 180.0,
                              .vertical_offset_m = 0.0,
                              .time_offset = std::chrono::nanoseconds{1152 * j}});
  }
  pattern.firing_period = std::chrono::nanoseconds{46080};
  pattern.minimum_range_m = 1.0;
  pattern.maximum_range_m = 100.0;
  return pattern;
}

void lidar_slice(benchmark::State& state) {
  SceneDescription description;
  description.rocks.emplace_back();
  const BuiltScene built = build_scene(description, {}, kSeed);
  const LidarPattern pattern = fan();
  LidarCommand command;
  command.rotor_rate_radps = 20.0 * std::numbers::pi;
  SpinningLidar lidar({}, pattern, {kStart + pattern.firing_period, pattern.firing_period}, command,
                      kSeed, "lidar");
  LinkMotion mount;
  mount.X_WL.translation() = Eigen::Vector3d(0.0, 0.0, 3.2);
  const Duration slice = std::chrono::milliseconds{state.range(0)};
  std::vector<LidarFiring> firings;
  SimTime t0 = kStart;
  for (auto _ : state) {
    built.scene->begin_slice(t0, t0 + slice, mount.X_WL.translation(), {});
    lidar.cast(*built.scene, {t0, t0 + slice, mount, mount}, nullptr, firings, nullptr);
    t0 += slice;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(lidar.rays()));
}
BENCHMARK(lidar_slice)->ArgName("ms")->Arg(1)->Arg(2)->Arg(5);

}  // namespace
}  // namespace rigwire::sim
