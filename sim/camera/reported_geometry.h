// The calibration that a camera with a third coordinate reports, so that its numbers can be turned
// into points. Its pictures are rectified to it.
//
// It holds for the whole picture, without binning. Pixels are counted as in lens.h, the middle of
// the first one at 0. The point of pixel (u, v) in the frame C of lens.h is:
//   stereo   Z = focal_length_px * baseline_m / disparity
//   depth    Z = the coordinate itself
//   X = (u - principal_u_px) Z / focal_length_px, and Y from v in the same way
#pragma once

#include "sim/samples/picture_sample.h"

namespace rigwire::sim {

struct ReportedGeometry {
  double focal_length_px = 0.0;
  double baseline_m = 0.0;  ///< Between the heads of a stereo camera; 0 for other kinds.
  double principal_u_px = 0.0;
  double principal_v_px = 0.0;
  CoordinateCoding coding;

  friend bool operator==(const ReportedGeometry&, const ReportedGeometry&) = default;
};

}  // namespace rigwire::sim
