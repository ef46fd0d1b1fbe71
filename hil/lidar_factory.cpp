#include "hil/lidar_factory.h"

#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::hil {

std::unique_ptr<sim::LidarSensor> make_lidar_sensor(const LidarSensorSettings& settings,
                                                    const LidarHead& head, std::uint64_t seed,
                                                    std::string_view name) {
  if (settings.method == LidarMethod::depth_image) {
    return std::make_unique<sim::DepthImageLidar>(settings.images, settings.sensor, head.pattern,
                                                  head.plan, head.command, seed, name,
                                                  settings.rotor);
  }
  return std::make_unique<sim::SpinningLidar>(settings.sensor, head.pattern, head.plan,
                                              head.command, seed, name, settings.rotor);
}

}  // namespace rigwire::hil
