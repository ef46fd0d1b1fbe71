// How well a spinning lidar measures.
#pragma once

namespace rigwire::sim {

struct SpinningLidarParameters {
  double range_sigma_m = 0.02;     ///< Of the Gaussian range noise, independent per shot.
  double housing_radius_m = 0.10;  ///< Rays begin here. Hits nearer than the pattern's minimum
                                   ///< range block the ray and are reported as none.
  int threads = 1;                 ///< That cast, the caller's included. Does not change results.
};

/// Throws std::invalid_argument naming the member, the value found and what is allowed.
void validate(const SpinningLidarParameters& parameters);

}  // namespace rigwire::sim
