#include "hil/world/lidar.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "hil/bench/lidar_cases.h"
#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::hil {
namespace {

TEST(LidarFactory, MakesTheSensorOfTheMethod) {
  const LidarHead head{bench_head(), bench_firing_plan(), bench_rotor()};
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
