// A beam's cross section as a few rays with weights.
//
// The beam is Gaussian and elliptical: intensity exp(-2 (x^2 / a^2 + y^2 / b^2)) at the angles x to
// the right and y up from its middle, with the half angles a and b of LaserBeam. The rays represent
// all of it, beyond the 1/e2 ellipse too; their weights sum to 1.
//
//   1     the middle
//   5     the middle (1/4) and four (3/16 each) at 0.7 half angles, a cross turned by atan(1/2)
//   19    a hexagonal grid of 0.45 half angles, turned by 15 degrees, weights exp(-1.2 (x^2 / a^2 +
//         y^2 / b^2)) made to sum to 1
//   1000  a spiral of equal weights (Vogel, "A better way to construct the sunflower head",
//         Mathematical Biosciences 44, 1979, with the radii of the Gaussian), to compare with
//
// Because of the turns no sub-ray is straight above or beside another, so that an upright or a
// level edge that moves through the beam uncovers them one by one. Radii and weights minimise the
// error of the energy beside a straight edge. That error, in shares of the pulse, for edges at all
// distances up to 1.25 half angles from the middle (tests/sim/lidar/beam_sampler_test.cpp):
//
//   rays  rms, all directions  rms, upright and level  worst, upright and level
//      1        0.216                 0.216                   0.500
//      5        0.073                 0.054                   0.125
//     19        0.030                 0.020                   0.046
//   1000        0.0015                0.0016                  0.006
#pragma once

#include <vector>

#include "sim/samples/lidar_sample.h"

namespace rigwire::sim {

struct SubRay {
  double right_rad = 0.0;  ///< From the beam's middle.
  double up_rad = 0.0;
  double weight = 1.0;
  /// Distance to its neighbours, for what lies between them.
  double spacing_right_rad = 0.0;
  double spacing_up_rad = 0.0;
};

/// The first one is the middle. Throws std::invalid_argument unless count is 1, 5, 19 or 1000 and
/// the divergences are finite and not negative.
[[nodiscard]] std::vector<SubRay> sample_beam(const LaserBeam& beam, int count);

/// Six rays around the beam that carry `share` of a pulse beside it: scattered light.
[[nodiscard]] std::vector<SubRay> sample_halo(double angle_rad, double share);

}  // namespace rigwire::sim
