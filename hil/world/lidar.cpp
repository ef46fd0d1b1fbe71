#include "hil/world/lidar.h"

#include "sim/lidar/depth_image_lidar.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::hil {

std::unique_ptr<sim::LidarSensor> make_lidar_sensor(const LidarSensorConfiguration& configuration,
                                                    const LidarHead& head, std::uint64_t seed,
                                                    std::string_view name) {
  if (configuration.method == LidarMethod::depth_image) {
    return std::make_unique<sim::DepthImageLidar>(configuration.images, configuration.beam,
                                                  head.pattern, head.plan, head.command, seed, name,
                                                  configuration.rotor);
  }
  return std::make_unique<sim::SpinningLidar>(configuration.beam, head.pattern, head.plan,
                                              head.command, seed, name, configuration.rotor);
}

}  // namespace rigwire::hil
