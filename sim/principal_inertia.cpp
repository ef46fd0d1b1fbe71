#include "sim/principal_inertia.h"

#include <string>

#include "fields/check.h"

namespace rigwire::sim {

void require_principal_inertia(const Eigen::Vector3d& moments_kgm2) {
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
