// The echo of one ray per beam in clear air: what most rigs need, and the quickest way to it.
//
// Formulas in link_budget.h; the receiver's figures are those of EchoModel.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <vector>

#include "sim/lidar/echo_model.h"
#include "sim/lidar/firing_block.h"
#include "sim/lidar/lidar_parameters.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::sim {

class ClearEcho {
 public:
  /// `head`: the packets that blocks are cast in.
  ClearEcho(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
            const EchoModel& receiver, const HeadLanes& head, std::uint64_t noise_key);

  /// Casts all rays of the block and writes the strongest echo of each, and the truth where it is
  /// asked for. Does not allocate; uses 60 kB of stack.
  void cast(const BlockCast& cast) const;

  /// Constant errors of the lasers, packet by packet, lane by lane.
  struct LaserErrors {
    std::vector<float> bias_m;
    std::vector<float> gain;  ///< Gain of the reflectivity.
  };

 private:
  float minimum_m_;
  float maximum_m_;
  float sigma_m_;
  float reflectivity_sigma_;
  float onset_;
  float echo_limit_m2_;  ///< Square of the range at which a white surface is just seen.
  std::uint64_t noise_key_;
  std::array<LaserErrors, kLanes> errors_;  ///< By the firings of a block, less 1.
};

}  // namespace rigwire::sim
