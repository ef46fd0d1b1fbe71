// A place where nothing is strewn.
#pragma once

#include <Eigen/Core>

namespace rigwire::sim {

/// A disc in which no rock and no tree is put.
struct KeepOut {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 5.0;
};

}  // namespace rigwire::sim
