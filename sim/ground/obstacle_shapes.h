// Geometry of one obstacle (box, sphere, cylinder, hull): what the ground asks of its shape.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "sim/ground/ground.h"

namespace rigwire::sim {

/// The obstacle as contact sees it, in its own frame.
[[nodiscard]] ConvexShape shape_of(const Obstacle& obstacle);

/// The rectangle of the horizontal plane in which the obstacle lies.
struct ObstacleBounds {
  Eigen::Vector2d lower_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d upper_m = Eigen::Vector2d::Zero();
};
/// Its highest point, in the world.
[[nodiscard]] double top_m(const Obstacle& obstacle);
[[nodiscard]] ObstacleBounds bounds(const Obstacle& obstacle);

/// Where the vertical line at (x, y) leaves the obstacle, upward.
struct ObstacleTop {
  double height_m = 0.0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
};
[[nodiscard]] std::optional<ObstacleTop> top(const Obstacle& obstacle, double x_m, double y_m);

/// How deep the point is inside, along the normal of the nearest face.
[[nodiscard]] std::optional<Penetration> inside(const Obstacle& obstacle,
                                                const Eigen::Vector3d& p_W);

/// How deep a disc overlaps the obstacle: the disc of that radius about `centre_W`, square to the
/// unit `axis_W`, against the nearest point of the obstacle in the disc's plane. Exact for every
/// shape and attitude (relative 1e-12); continuous as the disc moves.
struct DiscOverlap {
  double depth_m = 0.0;  ///< Along the normal.
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
};
[[nodiscard]] std::optional<DiscOverlap> disc_overlap(const Obstacle& obstacle,
                                                      const Eigen::Vector3d& centre_W,
                                                      const Eigen::Vector3d& axis_W,
                                                      double radius_m);

}  // namespace rigwire::sim
