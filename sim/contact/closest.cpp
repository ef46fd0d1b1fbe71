#include "sim/contact/closest.h"

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

// Bullet's float build has the same symbols: linked by mistake it would go wrong silently.
static_assert(sizeof(btScalar) == sizeof(double));

namespace {

using Vector = Eigen::Vector3d;

constexpr double kSame_m = 1e-6;   // GJK's number and its normal's gap agree.
constexpr double kShift_m = 2e-4;  // Shift of A before GJK is called again.
constexpr double kKeptShare = 1.0 / 3.0;
constexpr double kNearKept = 0.866;  // Cosine of 30 degrees.

btVector3 bullet(const Vector& v) {
  return {v.x(), v.y(), v.z()};
}

Vector eigen(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// A shape's core as Bullet asks for it: its support points, no margin.
class Core final : public btConvexShape {
 public:
  explicit Core(const ConvexShape& shape) : shape_(shape) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
  }

  btVector3 localGetSupportingVertex(const btVector3& direction) const override {
    return bullet(shape_.core_support(eigen(direction)));
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override {
    return bullet(shape_.core_support(eigen(direction)));
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions,
                                                         btVector3* found,
                                                         int count) const override {
    for (int i = 0; i < count; ++i) {
      found[i] = localGetSupportingVertexWithoutMargin(directions[i]);
    }
  }
  btScalar getMargin() const override { return 0.0; }

  // The rest of the interface is Bullet's own world's; the pair detector asks none of it.
  void project(const btTransform&, const btVector3&, btScalar&, btScalar&, btVector3&,
               btVector3&) const override {}
  void getAabb(const btTransform&, btVector3&, btVector3&) const override {}
  void getAabbSlow(const btTransform&, btVector3&, btVector3&) const override {}
  void setLocalScaling(const btVector3&) override {}
  const btVector3& getLocalScaling() const override { return m_unit; }
  void setMargin(btScalar) override {}
  int getNumPreferredPenetrationDirections() const override { return 0; }
  void getPreferredPenetrationDirection(int, btVector3&) const override {}
  void calculateLocalInertia(btScalar, btVector3&) const override {}
  const char* getName() const override { return "core"; }

 private:
  const ConvexShape& shape_;
  btVector3 m_unit{1.0, 1.0, 1.0};
};

/// Takes GJK's answer: normal from B to A in B's frame, distance along it.
struct Proposal final : btDiscreteCollisionDetectorInterface::Result {
  void setShapeIdentifiersA(int, int) override {}
  void setShapeIdentifiersB(int, int) override {}
  void addContactPoint(const btVector3& normal_on_b, const btVector3&, btScalar depth) override {
    found = true;
    normal = eigen(normal_on_b);
    distance_m = depth;
  }
  bool found = false;
  Vector normal = Vector::UnitZ();
  double distance_m = 0.0;
};

/// A in B's frame, moved.
class Pair {
 public:
  Pair(const PlacedShape& a, const PlacedShape& b)
      : a_(*a.shape),
        b_(*b.shape),
        R_BA_(b.X_WS.linear().transpose() * a.X_WS.linear()),
        p_BA_(b.X_WS.linear().transpose() * Vector(a.X_WS.translation() - b.X_WS.translation())) {}

  [[nodiscard]] double gap(const Vector& n) const {
    const Vector foot = R_BA_ * a_.support(R_BA_.transpose() * -n) + p_BA_;
    return n.dot(foot - b_.support(n));
  }

  /// What GJK and EPA say with A moved by that much; nothing when they find no direction.
  [[nodiscard]] std::optional<Separation> propose(const Vector& shift) const {
    const Core core_a(a_);
    const Core core_b(b_);
    btVoronoiSimplexSolver simplex;
    btGjkEpaPenetrationDepthSolver depth;
    btGjkPairDetector detector(&core_a, &core_b, CUSTOM_CONVEX_SHAPE_TYPE, CUSTOM_CONVEX_SHAPE_TYPE,
                               0.0, 0.0, &simplex, &depth);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA.setBasis({R_BA_(0, 0), R_BA_(0, 1), R_BA_(0, 2), R_BA_(1, 0), R_BA_(1, 1),
                                 R_BA_(1, 2), R_BA_(2, 0), R_BA_(2, 1), R_BA_(2, 2)});
    input.m_transformA.setOrigin(bullet(p_BA_ + shift));
    input.m_transformB.setIdentity();
    // No maximum distance is set: the direction of a detector that stops early is meaningless.
    Proposal proposal;
    detector.getClosestPoints(input, proposal, nullptr);
    const double length = proposal.normal.norm();
    if (!proposal.found || !(length > 0.5)) {
      return std::nullopt;
    }
    return Separation{proposal.normal / length,
                      proposal.distance_m - a_.rounding_m() - b_.rounding_m()};
  }

  [[nodiscard]] const Vector& p_BA() const { return p_BA_; }
  /// From the middle of B's box to that of A's.
  [[nodiscard]] Vector centres() const {
    const Vector line = R_BA_ * a_.middle_m() + p_BA_ - b_.middle_m();
    const double length = line.norm();
    return length > 1e-12 ? Vector(line / length) : Vector(Vector::UnitZ());
  }

 private:
  const ConvexShape& a_;
  const ConvexShape& b_;
  Eigen::Matrix3d R_BA_;
  Vector p_BA_;
};

}  // namespace

double gap_along(const PlacedShape& a, const PlacedShape& b, const Vector& normal_W) {
  return Pair(a, b).gap(b.X_WS.linear().transpose() * normal_W);
}

Separation separation(const PlacedShape& a, const PlacedShape& b, double reach_m,
                      std::span<const Vector> kept) {
  const Pair pair(a, b);
  const Eigen::Matrix3d R_WB = b.X_WS.linear();
  Vector best = Vector::UnitZ();
  double best_gap = -1e300;
  const auto consider = [&](const Vector& n) {
    const double gap = pair.gap(n);
    if (gap > best_gap) {
      best_gap = gap;
      best = n;
    }
    return gap;
  };
  bool deep = false;
  for (const Vector& axis_W : kept) {
    if (consider(R_WB.transpose() * axis_W) > reach_m) {
      return {R_WB * best, best_gap};
    }
  }
  Vector near = Vector::Zero();
  if (!kept.empty()) {
    const double thinner = std::min(a.shape->least_width_m(), b.shape->least_width_m());
    deep = best_gap < -kKeptShare * thinner;
    near = best;
  }
  const auto agreed = [&](const std::optional<Separation>& proposal, const Vector& shift) {
    if (!proposal) {
      return false;
    }
    if (deep && proposal->normal_W.dot(near) < kNearKept) {
      return true;  // Another way out, perhaps a shorter one: not while it is this deep in.
    }
    const double gap = consider(proposal->normal_W);
    return std::abs(gap + shift.dot(proposal->normal_W) - proposal->gap_m) < kSame_m;
  };
  const std::optional<Separation> first = pair.propose(Vector::Zero());
  if (!agreed(first, Vector::Zero())) {
    const Vector centres = pair.centres();
    const Vector n = first ? first->normal_W : centres;
    for (const Vector& direction : {n, Vector(-n), centres, Vector(-centres)}) {
      const Vector shift = kShift_m * direction;
      agreed(pair.propose(shift), shift);
    }
    if (best_gap == -1e300) {
      consider(centres);  // No direction at all.
    }
  }
  return {R_WB * best, best_gap};
}

std::optional<Separation> closest(const PlacedShape& a, const PlacedShape& b, double reach_m,
                                  std::span<const Vector> kept) {
  const Separation found = separation(a, b, reach_m, kept);
  return found.gap_m > reach_m ? std::nullopt : std::optional(found);
}

}  // namespace rigwire::sim
