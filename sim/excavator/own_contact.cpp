#include "sim/excavator/own_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigwire::sim {

namespace {

constexpr double kReach_m = 0.02;
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
  const double moved_m = travelled_m_ - step_m_;
  travelled_m_ = step_m_;
  room_m_ = std::numeric_limits<double>::infinity();
  for (Pair& pair : pairs_) {
    const ContactBody& outer = bodies_[pair.outer];
    const double arm = outer.X_LS.translation().norm() + outer.shape.reach_m();
    const ContactLink& link = links[outer.link];
    const ContactLink& other = links[bodies_[pair.inner].link];
    const double closing = (link.v_WL_W - other.velocity_W(link.X_WL.translation())).norm() +
                           arm * (link.w_WL_W - other.w_WL_W).norm();
    const double reach = kReach_m + h * closing;
    pair.apart_m -= moved_m;
    if (pair.apart_m > reach) {
      pair.memory.part();
    } else {
      pair.apart_m = meet(pair, h, reach, links);
    }
    room_m_ = std::min(room_m_, pair.apart_m - kReach_m);
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
  // An old axis that still parts them spares the search.
  if (const double gap_m = gap_along(a, b, kept); gap_m > reach_m + kReach_m) {
    pair.memory.part();
    return gap_m;
  }
  const Separation found = separation(a, b, reach_m, std::span(&kept, pair.memory.met() ? 1 : 0));
  pair.axis_L = link.X_WL.linear().transpose() * found.normal_W;
  if (found.gap_m > reach_m) {
    pair.memory.part();
    return found.gap_m;
  }
  const Manifold touch = manifold(a, b, found, reach_m);
  const ContactLaw law = law_in_a_row(body, base.stiffness_npm, kFriction);
  PairMemory::Step step(pair.memory);
  const std::size_t first = points_.size();
  for (std::size_t i = 0; i < touch.count && points_.size() < kMostPoints; ++i) {
    ContactPoint& point = points_.emplace_back();
    pair_of_.push_back(static_cast<std::uint32_t>(&pair - pairs_.data()));
    point.body = pair.outer;
    point.link = body.link;
    point.p_W = touch.points[i].p_W;
    point.gap_m = touch.points[i].gap_m;
    point.law = law;
    point.direction_W[0] = found.normal_W;
    step.remember(link.X_WL.inverse(Eigen::Isometry) * point.p_W, point);
  }
  const std::span<ContactPoint> own(points_.data() + first, points_.size() - first);
  step.start(own, law.stiffness_npm);
  for (ContactPoint& point : own) {
    const Eigen::Vector3d velocity = link.velocity_W(point.p_W) - other.velocity_W(point.p_W);
    point.begin(h, {point.direction_W[0].dot(velocity), point.direction_W[1].dot(velocity),
                    point.direction_W[2].dot(velocity)});
  }
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
    pair.memory.settling();
  }
  std::size_t of_pair = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ContactPoint& point = points_[i];
    Pair& pair = pairs_[pair_of_[i]];
    of_pair = i > 0 && pair_of_[i] == pair_of_[i - 1] ? of_pair + 1 : 0;
    const double depth_m = -(point.gap_m + h * point.end_mps[0]);
    pair.memory.settled(of_pair, point, depth_m);
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
