// A head with the elevations of an HDL-32E above level ground, and one revolution of it.
#pragma once

#include <cmath>
#include <vector>

#include "fields/constants.h"
#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/lidar_sensor.h"
#include "sim/samples/lidar_sample.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

inline constexpr double kRate_radps = 10.0 * kTurn;
inline constexpr Duration kRevolution = std::chrono::milliseconds{100};

/// Elevations in order, all beams from the origin at once.
inline LidarPattern ideal_head() {
  LidarPattern head;
  for (int i = 0; i < 32; ++i) {
    head.lasers.push_back({.elevation_rad = (-30.67 + 4.0 / 3.0 * i) * kTurn / 360.0});
  }
  head.firing_period = Duration{46080};
  head.minimum_range_m = 0.5;
  head.maximum_range_m = 100.0;
  return head;
}

/// The ideal head with the real one's offsets and delays.
inline LidarPattern real_head() {
  LidarPattern head = ideal_head();
  for (std::size_t i = 0; i < 32; ++i) {
    head.lasers[i].vertical_offset_m = -0.02883 * std::tan(head.lasers[i].elevation_rad);
    head.lasers[i].time_offset = Duration{1152 * static_cast<int>((i * 7) % 32)};
  }
  return head;
}

inline SamplePlan firing_plan() {
  return {kStart + Duration{46080}, Duration{46080}};
}

inline LidarCommand turning(double rate_radps = kRate_radps) {
  LidarCommand command;
  command.rotor_rate_radps = rate_radps;
  return command;
}

inline LinkMotion standing(double x, double y, double z) {
  LinkMotion motion;
  motion.X_WL.translation() << x, y, z;
  return motion;
}

inline HeightField level_ground() {
  HeightField field;
  field.cell_m = 1.0;
  field.columns = 401;
  field.rows = 401;
  field.origin_m = {-200.0, -200.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  return field;
}

inline SpinningLidarParameters noiseless() {
  SpinningLidarParameters receiver;
  receiver.range_sigma_m = 0.0;
  return receiver;
}

/// Firings of the first revolution in one slice, by a sensor that stands.
inline std::vector<LidarFiring> revolution(LidarSensor& lidar, Scene& scene,
                                           const LinkMotion& mount) {
  std::vector<LidarFiring> firings;
  const std::vector<BodyMotion> bodies(scene.body_count());
  scene.begin_slice(kStart, kStart + kRevolution, mount.X_WL.translation(), bodies);
  lidar.cast(scene,
             {.t0 = kStart, .t1 = kStart + kRevolution, .mount_at_t0 = mount, .mount_at_t1 = mount},
             nullptr, firings, nullptr);
  return firings;
}

}  // namespace rigwire::sim
