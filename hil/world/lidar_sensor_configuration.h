// How well a lidar measures, and by which model.
#pragma once

#include "fields/rules.h"
#include "sim/lidar/depth_image_parameters.h"
#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/rotor.h"

namespace rigwire::hil {

enum class LidarMethod {
  rays,         ///< sim::SpinningLidar
  depth_image,  ///< sim::DepthImageLidar
};

struct LidarSensorConfiguration {
  LidarMethod method = LidarMethod::rays;
  sim::SpinningLidarParameters beam;
  sim::DepthImageParameters images;  ///< Means nothing with LidarMethod::rays.
  sim::RotorParameters rotor;
};
void visit(fields::Visitor& v, LidarSensorConfiguration& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const LidarSensorConfiguration& configuration);

}  // namespace rigwire::hil
