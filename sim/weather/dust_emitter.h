// Where a machine stirs up dust: wheels on dry ground, a bucket that fills or empties.
#pragma once

#include <Eigen/Core>

namespace rigwire::sim {

struct DustEmitter {
  Eigen::Vector3d position_W = Eigen::Vector3d::Zero();
  double radius_m = 0.3;        ///< Of the fresh puff.
  double mass_rate_kgps = 0.0;  ///< Of what stays in the air, before the scene's own dustiness.
};

}  // namespace rigwire::sim
