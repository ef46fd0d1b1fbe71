// Depth between the pixel centres of a depth image.
//
// On a plane 1/z is an affine function of (u, v), so that its interpolation is exact there while
// that of z is not. Across a silhouette either yields a point in mid-air, on no surface.
//
// `edge_aware` tests the twelve pixels around: it interpolates only if, along rows and along
// columns, the step between the inner pixels continues the step on at least one side. (The four
// inner pixels alone are not enough: with a straight edge along a row or a column they still form a
// plane.)
#pragma once

#include <cstddef>

#include "sim/lidar/depth_image.h"
#include "sim/lidar/depth_image_geometry.h"
#include "sim/lidar/depth_image_parameters.h"

namespace rigwire::sim {

struct DepthLookup {
  double inverse_depth = 0.0;  ///< 1/z in 1/m; 0: nothing there.
  std::size_t pixel = 0;       ///< The nearest one, for surface and normal.
};

/// At a place in the image, or at the image's nearest place. Between its outermost pixel centres
/// and its edge, half a pixel, slopes continue.
[[nodiscard]] DepthLookup look_up(const DepthImage& image, const DepthImageGeometry& geometry,
                                  const ImagePoint& at, DepthSampling sampling);

}  // namespace rigwire::sim
