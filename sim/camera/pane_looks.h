// Panes of glass in the upright sides of things, averaged over a pixel's width.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "sim/camera/shading_lanes.h"
#include "sim/camera/surface_look.h"

namespace rigwire::sim {

/// Coordinates of a mesh with panes, and how the panes are arranged in its sides.
struct PaneFrame {
  std::array<float, 12> X{};  ///< Pose of the mesh in Embree's coordinates, column by column.
  Eigen::AlignedBox3f bounds_M;
  Panes panes;
};

/// At one lane, where X has the mesh now.
void glaze(const PaneFrame& pane, const std::array<float, 12>& X, const MetSurfaces& met,
           std::size_t lane, LitLanes& lit);

}  // namespace rigwire::sim
