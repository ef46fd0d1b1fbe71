// A place where nothing is strewn.
#pragma once

#include <Eigen/Core>

#include "fields/rules.h"

namespace rigwire::sim {

/// A disc in which no rock and no tree is put.
struct KeepOut {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 5.0;
};
void visit(fields::Visitor& v, KeepOut& p);

}  // namespace rigwire::sim
