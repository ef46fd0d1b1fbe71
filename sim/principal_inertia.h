// What the principal moments of inertia of any body keep.
#pragma once

#include <Eigen/Core>

namespace rigwire::sim {

/// Throws fields::Refused, at the key `principal_inertia`, where one moment exceeds the sum of the
/// other two: no distribution of mass has such moments.
void require_principal_inertia(const Eigen::Vector3d& moments_kgm2);

}  // namespace rigwire::sim
