#include "dig_cycle/lidar_wire.h"

#include <utility>

namespace rigwire::dig_cycle {

LidarWire::LidarWire(Surroundings& surroundings, std::function<ArmShape()> arm,
                     std::function<void()> heard)
    : wire_({.revolution = [&surroundings] { surroundings.finish_revolution(); },
             .points =
                 [&surroundings, arm = std::move(arm)](auto points) {
                   const ArmShape shape = arm();
                   for (const auto& point : points) {
                     surroundings.add({point.x_m, point.y_m, point.z_m}, shape);
                   }
                 },
             .heard = std::move(heard)}) {}

}  // namespace rigwire::dig_cycle
