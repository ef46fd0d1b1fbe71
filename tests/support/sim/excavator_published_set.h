// REF-18t as the oracle values were computed with it (research table, checked there against
// Simbody and DART): the bucket's lug lies on the line from pin to tip, and the centre of mass on
// its other side. The product's default differs in those two entries, because a bucket pinned that
// way cannot curl under the stick (docs/machines/excavator.md).
#pragma once

#include <cmath>
#include <numbers>

#include "sim/excavator/driven_arm.h"

namespace rigwire::sim {

inline ExcavatorParameters published_set() {
  ExcavatorParameters parameters;
  parameters.bucket_linkage.lug_angle_rad = 0.0;
  parameters.bucket.center_of_mass_m = {0.60, 0.0, -0.20};
  parameters.payload_center_of_mass_m = {0.65, 0.0, -0.25};
  parameters.gravity_mps2 = 9.81;
  parameters.initial = {0.0, 0.35, -1.4, 0.6};
  return parameters;
}

inline const Eigen::Vector3d kPublishedGravity{0.0, 0.0, -9.81};

}  // namespace rigwire::sim
