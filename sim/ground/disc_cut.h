// A wheel's disc against a terrain profile in its own plane, and against several things at once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "sim/ground/ground.h"

namespace rigwire::sim {

/// Where the profile is looked up, in radii ahead of the disc's lowest point: close together where
/// a loaded tyre touches.
inline constexpr std::size_t kProfilePoints = 7;
inline constexpr std::array<double, kProfilePoints> kProfilePlaces{-0.85, -0.45, -0.2, 0.0,
                                                                   0.2,   0.45,  0.85};

/// In the disc's plane: x ahead, y up, origin in its centre.
struct DiscCut {
  double depth_m = 0.0;
  Eigen::Vector2d normal = Eigen::Vector2d::UnitY();  ///< Unit, away from the ground.
};

/// The disc about the origin against everything below the polyline, whose first and last pieces go
/// on for ever; points in order of rising x. Nothing when the disc is free.
///
/// With A the area cut off and T the vector from where the polyline enters the disc to where it
/// leaves (summed over all its visits): normal square to T; depth = d |T| / T(d), d the depth of
/// the straight cut with area A, T(d) its chord. As dA = -|T| normal . dcentre, a force that
/// depends on d as on a plane, times |T| / T(d), has a potential. Exact for a straight profile.
[[nodiscard]] std::optional<DiscCut> cut_disc(
    const std::array<Eigen::Vector2d, kProfilePoints>& profile, double radius_m);

/// Depth of the straight cut through a disc that takes off the area (at most half the disc's).
[[nodiscard]] double straight_cut_depth_m(double area_m2, double radius_m);

/// How to leave several overlaps at once.
struct Escape {
  Eigen::Vector3d way_W = Eigen::Vector3d::Zero();
  std::array<double, 5> shares{};  ///< Share of each overlap's normal in the way, 0 or more.
};

/// The shortest displacement with normal . way >= depth for each overlap (at most two of them
/// bind). Continuous in depths and normals. Precondition: 1 .. 5 overlaps.
[[nodiscard]] Escape shortest_escape(std::span<const Penetration> overlaps);

}  // namespace rigwire::sim
