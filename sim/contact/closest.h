// How far apart two convex solids are, and which way they part.
//
// For a unit direction n the gap along it, gap(n) = min over A of p . n - max over B of p . n,
// costs two support points and is never above the signed distance; that is the greatest gap over
// all n, and the n which has it is the normal. GJK and EPA (Bullet in double precision, margin 0,
// poses taken relative to B) propose normals; what is reported is gap(n) of the best one, not GJK's
// own number. A proposal whose number differs from its gap by more than a micrometre is asked for
// again with A moved by 0.2 mm. That mends the few wrong normals of exactly touching bodies.
//
// Error against closed forms: gap 5e-6 m, normal 0.1 degrees (tests/sim/contact/closest_test.cpp).
// Deep overlaps: the shortest way out, or the way kept from before.
//
// Gilbert, Johnson, Keerthi, IEEE J. Robotics Automation 4 (1988) 193; van den Bergen, Collision
// Detection in Interactive 3D Environments (2004), chapter 4.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "sim/contact/convex_shape.h"

namespace rigwire::sim {

struct Separation {
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< Unit, from B towards A.
  double gap_m = 0.0;                                   ///< Along the normal; negative: overlap.
};

/// A convex solid somewhere.
struct PlacedShape {
  const ConvexShape* shape = nullptr;
  Eigen::Isometry3d X_WS = Eigen::Isometry3d::Identity();

  [[nodiscard]] Eigen::Vector3d support_W(const Eigen::Vector3d& direction_W) const {
    return X_WS * shape->support(X_WS.linear().transpose() * direction_W);
  }
};

/// gap(n) above. Precondition: n is a unit vector.
[[nodiscard]] double gap_along(const PlacedShape& a, const PlacedShape& b,
                               const Eigen::Vector3d& normal_W);

/// The gap of a pair that is farther apart than `reach_m` is a lower bound along some axis. `kept`
/// are the pair's normal of the step before as it stands in the world, and as it turns with A: one
/// that parts the bodies by more than the reach spares everything else, one on which they are close
/// competes with what is found anew, and while they overlap by more than a third of the thinner one
/// only what is found within 30 degrees of them counts, so that nothing is pushed out at its far
/// side. Allocates nothing; reentrant.
[[nodiscard]] Separation separation(const PlacedShape& a, const PlacedShape& b, double reach_m,
                                    std::span<const Eigen::Vector3d> kept = {});

/// separation(), nothing when A and B are farther apart than `reach_m`.
[[nodiscard]] std::optional<Separation> closest(const PlacedShape& a, const PlacedShape& b,
                                                double reach_m,
                                                std::span<const Eigen::Vector3d> kept = {});

}  // namespace rigwire::sim
