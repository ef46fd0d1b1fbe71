#include "sim/excavator/own_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigwire::sim {

namespace {

constexpr double kReach_m = 0.02;
constexpr double kFreshOverlap_m = 1e-4;  // A spring may always hold so much.
constexpr double kSamePlace_m = 0.05;
constexpr double kFriction = 0.3;  // Steel on steel.

}  // namespace

OwnContact::OwnContact(std::vector<ContactBody> bodies) : bodies_(std::move(bodies)) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (bodies_[i].link > bodies_[k].link + 1) {
        Pair& pair = pairs_.emplace_back();
        pair.outer = i;
        pair.inner = k;
      }
    }
  }
  points_.reserve(kMostPoints);
  pair_of_.reserve(kMostPoints);
}

void OwnContact::begin(double h, std::span<const ContactLink> links) {
  points_.clear();
  pair_of_.clear();
  travelled_m_ = 0.0;
  room_m_ = std::numeric_limits<double>::infinity();
  for (Pair& pair : pairs_) {
    const ContactBody& outer = bodies_[pair.outer];
    const double arm = outer.X_LS.translation().norm() + outer.shape.reach_m();
    const ContactLink& link = links[outer.link];
    const ContactLink& other = links[bodies_[pair.inner].link];
    const double closing = (link.v_WL_W - other.velocity_W(link.X_WL.translation())).norm() +
                           arm * (link.w_WL_W - other.w_WL_W).norm();
    const double reach = kReach_m + h * closing;
    room_m_ = std::min(room_m_, meet(pair, h, reach, links) - kReach_m);
  }
}

double OwnContact::meet(Pair& pair, double h, double reach_m, std::span<const ContactLink> links) {
  const ContactBody& body = bodies_[pair.outer];
  const ContactBody& base = bodies_[pair.inner];
  const ContactLink& link = links[body.link];
  const ContactLink& other = links[base.link];
  const PlacedShape a{&body.shape, link.X_WL * body.X_LS};
  const PlacedShape b{&base.shape, other.X_WL * base.X_LS};
  const Eigen::Vector3d kept = link.X_WL.linear() * pair.axis_L;
  const auto apart = [&pair](double gap_m) {
    pair.met = false;
    pair.remembered = 0;
    pair.spring_j = 0.0;
    return gap_m;
  };
  // An old axis that still parts them spares the search.
  if (const double gap_m = gap_along(a, b, kept); gap_m > reach_m + kReach_m) {
    return apart(gap_m);
  }
  const Separation found = separation(a, b, reach_m, std::span(&kept, pair.met ? 1 : 0));
  pair.axis_L = link.X_WL.linear().transpose() * found.normal_W;
  if (found.gap_m > reach_m) {
    return apart(found.gap_m);
  }
  const bool met_before = std::exchange(pair.met, true);
  const Eigen::Vector3d& n = found.normal_W;
  const Manifold touch = manifold(a, b, found, reach_m);
  std::array<Memory, kManifoldPoints> memory;
  std::size_t remembered = 0;
  const double stiffness = 1.0 / (1.0 / body.stiffness_npm + 1.0 / base.stiffness_npm);
  const std::size_t first = points_.size();
  for (std::size_t i = 0; i < touch.count && points_.size() < kMostPoints; ++i) {
    ContactPoint& point = points_.emplace_back();
    pair_of_.push_back(static_cast<std::uint32_t>(&pair - pairs_.data()));
    point.body = pair.outer;
    point.link = body.link;
    point.p_W = touch.points[i].p_W;
    point.gap_m = touch.points[i].gap_m;
    point.law.stiffness_npm = stiffness;
    point.law.damping_nspm = body.damping_nspm * std::sqrt(stiffness / body.stiffness_npm);
    point.law.friction = kFriction;
    point.law.bristle_npm = 0.5 * stiffness;
    // Friction of the nearest point of before, its directions turned with the normal.
    const Eigen::Vector3d p_L = link.X_WL.inverse(Eigen::Isometry) * point.p_W;
    Eigen::Vector3d across =
        std::abs(n.x()) < 0.8 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    for (std::size_t k = 0; k < pair.remembered; ++k) {
      Memory& near = pair.memory[k];
      if ((near.p_L - p_L).norm() < kSamePlace_m &&
          near.friction.first_W.cross(n).squaredNorm() > 0.25) {
        point.friction = near.friction;
        across = near.friction.first_W;
        near.p_L.setConstant(1e300);  // One point's alone.
        break;
      }
    }
    const Eigen::Vector3d t1 = (across - across.dot(n) * n).normalized();
    point.friction.first_W = t1;
    point.direction_W = {n, t1, n.cross(t1)};
    memory[remembered++].p_L = p_L;
  }
  const std::span<ContactPoint> own(points_.data() + first, points_.size() - first);
  double overlap = 0.0;
  for (const ContactPoint& point : own) {
    overlap = std::max(overlap, -point.gap_m);
  }
  pair.rest_m = met_before ? std::min(pair.rest_m, overlap) : overlap;
  double spring = 0.0;
  for (ContactPoint& point : own) {
    point.rest_m = pair.rest_m;
    point.gap_m += pair.rest_m;
    spring += point.spring_j(-point.gap_m);
  }
  // No more in the springs than at the end of the step before.
  const double allowed = pair.spring_j + 0.5 * stiffness * kFreshOverlap_m * kFreshOverlap_m;
  const double share = spring > allowed ? allowed / spring : 1.0;
  for (ContactPoint& point : own) {
    point.law.stiffness_npm *= share;
    const Eigen::Vector3d velocity = link.velocity_W(point.p_W) - other.velocity_W(point.p_W);
    point.begin(h, {point.direction_W[0].dot(velocity), point.direction_W[1].dot(velocity),
                    point.direction_W[2].dot(velocity)});
  }
  pair.memory = memory;
  pair.remembered = remembered;
  return found.gap_m;
}

void OwnContact::shorten(double h) {
  for (ContactPoint& point : points_) {
    point.begin(h, point.start_mps);
  }
}

void OwnContact::finish(double h) {
  force_n_ = 0.0;
  outer_ = inner_ = {};
  double most = 0.0;
  for (Pair& pair : pairs_) {
    pair.spring_j = 0.0;
  }
  std::size_t of_pair = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ContactPoint& point = points_[i];
    Pair& pair = pairs_[pair_of_[i]];
    of_pair = i > 0 && pair_of_[i] == pair_of_[i - 1] ? of_pair + 1 : 0;
    pair.memory[of_pair].friction = point.friction;
    const double depth_m = -(point.gap_m + h * point.end_mps[0]);
    pair.spring_j += point.spring_j(depth_m);
    deepest_ever_m_ = std::max(deepest_ever_m_, depth_m);
    force_n_ += point.force_n[0];
    if (point.force_n[0] > most) {
      most = point.force_n[0];
      outer_ = bodies_[pair.outer].name;
      inner_ = bodies_[pair.inner].name;
    }
  }
}

}  // namespace rigwire::sim
