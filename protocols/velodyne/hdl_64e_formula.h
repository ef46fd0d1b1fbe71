// The constants of an HDL-64E client's formula (hdl_64e_calibration.h), for those that compute it.
#pragma once

#include "protocols/velodyne/hdl_64e_calibration.h"

namespace rigwire::protocols::velodyne {

/// Where the three distance corrections were found (S2.1 manual, appendix F).
inline constexpr double kFarPoint_m = 25.04;
inline constexpr double kNearPointX_m = 2.40;
inline constexpr double kNearPointY_m = 1.93;

/// Reach of the distance field, and scale, in the formula of the intensity.
inline constexpr double kIntensityReach_m = 131.0;
inline constexpr double kDistanceField = 65535.0;
inline constexpr double kIntensityScale = 256.0;

/// Without near corrections the far one holds everywhere.
[[nodiscard]] inline bool has_near_correction(const Hdl64eLaser& laser) {
  return laser.dist_correction_x_m != 0.0 || laser.dist_correction_y_m != 0.0;
}

}  // namespace rigwire::protocols::velodyne
