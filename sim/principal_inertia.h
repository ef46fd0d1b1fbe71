// What the principal moments of inertia of any body keep.
#pragma once

#include <Eigen/Core>
#include <string>

#include "fields/check.h"

namespace rigwire::sim {

/// Throws fields::Refused, at the key `principal_inertia`, where one moment exceeds the sum of the
/// other two: no distribution of mass has such moments.
inline void require_principal_inertia(const Eigen::Vector3d& moments_kgm2) {
  constexpr double kRounding = 1e-9;
  constexpr fields::NumberRule kUnit = fields::in("kg m2");
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double found = moments_kgm2[i];
    const double others = moments_kgm2.sum() - found;
    fields::require(found <= others * (1.0 + kRounding), "principal_inertia." + std::to_string(i),
                    kUnit.print(found), "at most the sum of the other two, " + kUnit.print(others));
  }
}

}  // namespace rigwire::sim
