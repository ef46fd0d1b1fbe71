// What sub-rays cost, and how far their echoes are from those of beams of a thousand.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire::bench {

/// Echoes of 1, 5 or 19 sub-rays compared with those of 1000 on the same shots, without noise, with
/// the last echo separate. A shot is wrong when its echo is more than half a pulse's length (0.75
/// m) from the reference's, or when only one of the two has an echo.
struct SubRayError {
  std::string scene;
  int sub_rays = 0;
  std::size_t shots = 0;         ///< Shots in which the reference or this one had an echo.
  double wrong_strongest = 0.0;  ///< Share of the shots.
  double wrong_last = 0.0;       ///< Share of the shots.
  double rms_m = 0.0;            ///< Error of the strongest echo's range, where the echo is right.
  /// Error of the strongest echo's reflectivity, where the echo is right.
  double reflectivity_rms = 0.0;
  double rays_per_s = 0.0;  ///< CPU time of one thread, echo model included.
  double cost = 0.0;        ///< CPU time over that of one ray per beam.
};

/// Measures over `sector` of simulated time, at least 1 ms: a turn takes 100 ms. Throws
/// std::invalid_argument when it is shorter.
[[nodiscard]] std::vector<SubRayError> measure_sub_rays(Duration sector);

}  // namespace rigwire::bench
