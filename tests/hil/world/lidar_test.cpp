#include "hil/world/lidar.h"

#include <gtest/gtest.h>

#include <chrono>
#include <numbers>
#include <stdexcept>

#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::hil {
namespace {

/// 600 rpm.
LidarHead two_lasers() {
  constexpr Duration kFiringPeriod = std::chrono::microseconds{50};
  LidarHead head;
  head.pattern.lasers = {{.elevation_rad = 0.0},
                         {.elevation_rad = -0.1, .time_offset = std::chrono::microseconds{1}}};
  head.pattern.firing_period = kFiringPeriod;
  head.pattern.minimum_range_m = 1.0;
  head.pattern.maximum_range_m = 100.0;
  head.plan = {kStart + kFiringPeriod, kFiringPeriod};
  head.command.rotor_rate_radps = 20.0 * std::numbers::pi;
  return head;
}

TEST(LidarFactory, MakesTheSensorOfTheMethod) {
  const LidarHead head = two_lasers();
  LidarSensorConfiguration settings;
  settings.images.width_px = 64;
  EXPECT_NE(dynamic_cast<sim::SpinningLidar*>(make_lidar_sensor(settings, head, 1, "a").get()),
            nullptr);
  settings.method = LidarMethod::depth_image;
  EXPECT_NE(dynamic_cast<sim::DepthImageLidar*>(make_lidar_sensor(settings, head, 1, "a").get()),
            nullptr);
  settings.beam.sub_rays = 5;
  EXPECT_THROW((void)make_lidar_sensor(settings, head, 1, "a"), std::invalid_argument);
  settings.method = LidarMethod::rays;
  EXPECT_NO_THROW((void)make_lidar_sensor(settings, head, 1, "a"));
}

}  // namespace
}  // namespace rigwire::hil
