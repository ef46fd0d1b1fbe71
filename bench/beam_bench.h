// What sub-rays cost, and how far their echoes are from those of beams of a thousand.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire::bench {

/// Echoes of 1, 5 or 19 sub-rays against those of 1000 on the same shots, without noise, with the
/// last echo told apart. A shot is wrong when its echo is more than half a pulse's length (0.75 m)
/// from the reference's, or there is one where the other sees none.
struct SubRayError {
  std::string scene;
  int sub_rays = 0;
  std::size_t shots = 0;          ///< In which the reference or this one saw something.
  double wrong_strongest = 0.0;   ///< Share of the shots.
  double wrong_last = 0.0;        ///< Share of the shots.
  double rms_m = 0.0;             ///< Of the range of the strongest echo, where it is right.
  double reflectivity_rms = 0.0;  ///< Of the strongest echo, where it is right.
  double rays_per_s = 0.0;        ///< CPU time of one thread, echo model included.
  double cost = 0.0;              ///< CPU time over that of one ray per beam.
};

/// Over `sector` of simulated time, at least 1 ms: a turn takes 100 ms. Throws
/// std::invalid_argument when it is shorter.
///
/// Three scenes of the benchmark's own, each on level ground: poles before a wall,
/// crowns of leaves, crates. HDL-32E, beam of 3 x 1.5 mrad (VLS-128 manual 63-9483, appendix F, the
/// one divergence that Velodyne states).
[[nodiscard]] std::vector<SubRayError> measure_sub_rays(Duration sector);

}  // namespace rigwire::bench
