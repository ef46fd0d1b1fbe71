// The echo of one ray per beam in clear air: what most rigs need, and the quickest way to it.
//
// A surface of diffuse reflectance rho met at incidence angle theta is seen up to
//   R_det = R_max sqrt(rho cos(theta) / 0.9),
// the range at which it returns as much light as a 90 % target does at R_max (Goodin et al.,
// "Predicting the influence of rain on lidar in ADAS", Electronics 8(1):89, 2019, without rain).
// The reported reflectivity is rho cos(theta): the sensor compensates range, not incidence.
#pragma once

#include <embree3/rtcore.h>

#include <cstdint>

#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::sim {

class ClearEcho {
 public:
  ClearEcho(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
            std::uint64_t noise_key);

  /// Casts all rays of the block and writes the strongest echo of each, and the truth where it is
  /// asked for. Does not allocate.
  void cast(const BlockCast& cast) const;

 private:
  float minimum_m_;
  float maximum_m_;
  float sigma_m_;
  float echo_limit_m2_;  ///< Square of the range at which rho cos(theta) = 1 is just seen.
  std::uint64_t noise_key_;
};

}  // namespace rigwire::sim
