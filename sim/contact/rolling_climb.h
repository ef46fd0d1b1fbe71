// How high a step a rigid drum climbs, between a wall and what it rolls over.
//
// A drum of radius R touches the edge of a step of height h at the angle t round from its lowest
// line, h = R (1 - cos t). With friction mu_e at the edge, and what the rest of the machine pushes
// being mu_o times the load that it carries, it is brought over the edge while
//
//     tan(t - atan mu_e) <= mu_o   or   t <= atan mu_e + atan mu_o
//
// (loads of both drums alike). In motion it has, beside that, the part of its speed that is along
// the way up, v cos t; its half of the machine is lifted by the energy of the whole: (v cos t)^2/g.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/ground/ground.h"

namespace rigwire::sim {

struct RollingClimb {
  /// Cosine of the steepest angle from the drum's lowest line at which it rolls over anything.
  static constexpr double kSteepest = 0.3;
  /// Cosine of 30 degrees: terrain up to this counts as a slope, not an edge.
  static constexpr double kSlope = 0.87;

  double radius_m = 0.0;  ///< 0: it rolls over everything lower than its middle.
  double grip = 0.0;      ///< Factor of the drum's surface on the ground's friction.
  /// Angle atan(mu_o), with mu_o the push of the rest of the machine over the load.
  double helped_rad = 0.0;
  double run_m = 0.0;  ///< v^2 / g.

  /// Returns the maximum height above its lowest line that it climbs on something of that friction.
  [[nodiscard]] double height_m(double friction) const {
    const double steepest = radius_m * (1.0 - kSteepest);
    const double angle = std::atan(grip * friction) + helped_rad;
    if (angle >= std::acos(kSteepest)) {
      return steepest;
    }
    const double c = std::cos(angle);
    return std::min(radius_m * (1.0 - c) + run_m * c * c, steepest);
  }
};

/// Whether a drum with its middle there, `up_W` the unit vector from its lowest line to it, comes
/// over an obstacle.
[[nodiscard]] bool climbs(const RollingClimb& climb, const Ground& ground, std::size_t obstacle,
                          const Eigen::Vector3d& middle_W, const Eigen::Vector3d& up_W);

}  // namespace rigwire::sim
