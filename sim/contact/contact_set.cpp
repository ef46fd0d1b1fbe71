#include "sim/contact/contact_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "fields/constants.h"
#include "sim/contact/loose_bodies.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr std::size_t kMostPairs = 512;
constexpr std::size_t kMostLeaning = 64;
constexpr double kHinge_rad = 0.1;  // Up to here an obstacle that yields keeps its moment,
constexpr double kDown_rad = 0.4;   // from here on it has none.
constexpr double kLeastHeight_m = 0.3;
// Stiffness of the ground under one point: a plate of 0.3 m radius on dense gravel, 2 a E / (1 -
// nu^2) with 80 MPa (Boussinesq's rigid punch); an estimate.
constexpr double kTerrain_npm = 5e7;
// A body that is lower than this is checked in each step. A higher one is checked when the fastest
// point has moved a quarter of its height, since the terrain may be steep.
constexpr double kLow_m = 0.1;
constexpr double kResolved =
    1.0;  // (Step x frequency)^2 of what lies loose on a machine's springs.
constexpr double kLooseDampingRatio = 0.3;  // With the mass of what lies loose.
// Height assumed for a drum far from walls: checked again after 0.1 m.
constexpr double kNoWall_m = 0.45;
constexpr double kSteep = RollingClimb::kSlope;
constexpr double kRollsOver = RollingClimb::kSteepest;

/// Half lengths, along the world's axes, of the box about a placed shape.
Vector half_box(const ConvexShape& shape, const Eigen::Matrix3d& R) {
  return R.cwiseAbs() * shape.half_lengths_m();
}

// Whether around a drum, as far as it may come before this is asked again, any terrain rises so
// high against `up_W` that it does not roll over it.
bool wall_near(const Ground& ground, const ContactBody& body, const Eigen::Isometry3d& X_WS,
               const Vector& up_W) {
  constexpr double kApart_m = 0.1;
  constexpr double kAhead_m = 0.15;
  const double radius = body.shape.half_lengths_m().x();
  // A drum's climb is lowest on frictionless ground.
  const double climbs = body.climb.radius_m > 0.0 ? body.climb.height_m(0.0) / radius : 1.0;
  const double wall = std::max(kRollsOver, std::min(kSteep, 1.0 - climbs));
  const double half_length = body.shape.half_lengths_m().z();
  const Vector axle_W = X_WS.linear().col(2);
  const Vector ahead_W = axle_W.cross(up_W);
  for (const double side : {-1.0, 0.0, 1.0}) {
    const Vector middle = X_WS.translation() + side * half_length * axle_W;
    for (double x = -radius - kAhead_m; x < radius + kAhead_m + kApart_m; x += kApart_m) {
      Vector p = middle + x * ahead_W;
      p.z() = ground.height_m(p.x(), p.y());
      if ((p - middle).dot(up_W) > -(wall + 0.1) * radius) {
        return true;
      }
    }
  }
  return false;
}

/// Square of the distance of p from the segment between a and b.
double from_segment2(const Vector& p, const Vector& a, const Vector& b) {
  const Vector way = b - a;
  const double length2 = way.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp(way.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - share * way).squaredNorm();
}

/// The terrain under p, and how far p is above it along its normal.
std::pair<GroundPoint, double> from_above(const Ground& ground, const Vector& p) {
  const GroundPoint under = ground.terrain_at(p.x(), p.y());
  return {under, (p.z() - under.height_m) * under.normal_W.z()};
}

// Terrain contact of a point p deep in the ground. Follows the line to p from the first of
// `outside` that is above ground. Where it enters through terrain that is steep against the surface
// above p, returns the terrain there and the distance of p from it; else from_above().
std::pair<GroundPoint, double> from_outside(const Ground& ground, std::array<Vector, 2> outside,
                                            const Vector& p) {
  constexpr double kApart_m = 0.05;
  std::pair<GroundPoint, double> found = from_above(ground, p);
  const auto above = [&](const Vector& q) { return q.z() > ground.height_m(q.x(), q.y()); };
  const auto* const start = std::ranges::find_if(outside, above);
  if (start == outside.end()) {
    return found;
  }
  const Vector way = p - *start;
  const double step = std::min(1.0, kApart_m / way.norm());
  double in = step;
  while (in < 1.0 && above(*start + in * way)) {
    in = std::min(1.0, in + step);
  }
  double out = in - step;
  for (int i = 0; i < 8; ++i) {
    const double s = 0.5 * (out + in);
    (above(*start + s * way) ? out : in) = s;
  }
  const Vector entry = *start + in * way;
  const GroundPoint at = ground.terrain_at(entry.x(), entry.y());
  if (at.normal_W.dot(found.first.normal_W) > kSteep) {
    return found;
  }
  return {at, (p - entry).dot(at.normal_W)};
}

// A cylinder that rolls, and does not lie on an end.
bool rolls_on(const ContactBody& body, const Eigen::Isometry3d& X_WS) {
  constexpr double kOnItsSide = 0.5;  // Cosine between axle and vertical.
  return body.rolls && std::abs(X_WS.linear()(2, 2)) < kOnItsSide;
}

// Whether terrain with this normal blocks a body whose machine models its own support.
bool in_the_way(const ContactBody& body, const Eigen::Matrix3d& R_WL, const Vector& normal_W,
                double friction) {
  double steepest = body.rolls ? kRollsOver : kSteep;
  if (body.climb.radius_m > 0.0) {
    const double climbs = body.climb.height_m(friction) / body.climb.radius_m;
    steepest = std::min(kSteep, 1.0 - climbs);
  }
  return normal_W.dot(R_WL.col(2)) < steepest;
}

}  // namespace

ContactLaw law_in_a_row(const ContactBody& body, double other_npm, double friction,
                        std::size_t points) {
  ContactLaw law;
  const double share = body.soft ? 1.0 / static_cast<double>(points) : 1.0;
  const double own_npm = share * body.stiffness_npm;
  law.stiffness_npm = 1.0 / (1.0 / own_npm + (other_npm > 0.0 ? 1.0 / other_npm : 0.0));
  law.body_share = law.stiffness_npm / own_npm;
  law.damping_nspm = share * body.damping_nspm * std::sqrt(law.body_share);
  law.friction = friction;
  law.bristle_npm = 0.5 * law.stiffness_npm;
  return law;
}

ContactSet::ContactSet(std::vector<ContactBody> bodies, std::size_t links, const Ground& ground,
                       const Movers* siblings)
    : ground_(&ground), siblings_(siblings), bodies_(std::move(bodies)), links_(links) {
  surface_m_.resize(bodies_.size());
  for (const ContactBody& body : bodies_) {
    if (body.link >= links_ || !(body.stiffness_npm > 0.0) || !(body.damping_nspm >= 0.0) ||
        !(body.crush_n >= 0.0) || !(body.crush_npm >= 0.0)) {
      throw std::invalid_argument("contact: body '" + body.name + "' needs a link below " +
                                  std::to_string(links_) +
                                  ", a stiffness above 0, a damping and crush of at least 0");
    }
    if (body.meets_terrain) {
      surface_m_[static_cast<std::size_t>(&body - bodies_.data())] =
          body.shape.surface(body.spacing_m);
    }
  }
  std::size_t most = 0;
  for (const std::vector<Vector>& surface : surface_m_) {
    most = std::max(most, surface.size());
  }
  touches_.reserve(std::max(most + 1 + kMostFeaturePoints, kMostSidePlaces));
  places_.reserve(kMostSidePlaces);
  for (const SoilParameters& soil : ground.soils()) {
    bearing_.emplace_back(soil);
  }
  // Each loose body touches a few others.
  const std::size_t loose = siblings_ != nullptr ? bodies_.size() : 0;
  const std::size_t most_pairs = std::max(kMostPairs, 32 * loose);
  const std::size_t most_points = std::max(kMostContactPoints, 4 * kManifoldPoints * loose);
  pairs_.reserve(most_pairs);
  others_.reserve(most_pairs);
  found_.reserve(4 * kMostPairs);
  points_.reserve(most_points);
  pair_of_.reserve(most_points);
  leaning_.reserve(kMostLeaning);
  at_.resize(links_);
  moved_m_.resize(bodies_.size());
}

Eigen::Isometry3d ContactSet::pose_of(std::size_t obstacle) const {
  const Obstacle& still = ground_->obstacles()[obstacle];
  Eigen::Isometry3d X_WO = still.X_WO;
  for (const LeaningObstacle& lean : leaning_) {
    if (lean.obstacle == obstacle && !lean.solid) {
      X_WO = lean.motion_W(still.foot_W()) * still.X_WO;
    }
  }
  return X_WO;
}

double ContactSet::strength_of(std::size_t obstacle) const {
  const double strength = ground_->obstacles()[obstacle].strength_nm;
  for (const LeaningObstacle& lean : leaning_) {
    if (lean.obstacle == obstacle && !lean.solid) {
      const double left = (kDown_rad - lean.angle_rad) / (kDown_rad - kHinge_rad);
      return lean.down ? 0.0 : strength * std::clamp(left, 0.0, 1.0);
    }
  }
  return strength;
}

LeaningObstacle* ContactSet::lean_of(std::size_t obstacle) {
  for (LeaningObstacle& lean : leaning_) {
    if (lean.obstacle == obstacle) {
      return &lean;
    }
  }
  return nullptr;
}

std::span<const Mover> ContactSet::others() const {
  const Movers* movers = siblings_ != nullptr ? siblings_ : ground_->loose();
  return movers != nullptr ? movers->movers() : std::span<const Mover>();
}

const Mover* ContactSet::mover_of(std::uint32_t obstacle) const {
  const std::size_t fixed = ground_->obstacles().size();
  return obstacle == kTerrain || obstacle < fixed ? nullptr : &others()[obstacle - fixed];
}

double ContactSet::move_others(double h, double fastest_mps) {
  if (siblings_ != nullptr) {
    travelled_m_ += h * fastest_mps;
    return fastest_mps;
  }
  if (Movers* loose = ground_->loose(); loose != nullptr && others_due_s_ > 0.0) {
    others_mps_ = loose->advance(others_due_s_);
    travelled_m_ += others_due_s_ * others_mps_;
  }
  others_due_s_ = h;
  return others_mps_;
}

void ContactSet::follow_others() {
  for (std::size_t at = 0; at < points_.size();) {
    const std::size_t first = at;
    Pair& pair = pairs_[pair_of_[first]];
    while (at < points_.size() && pair_of_[at] == pair_of_[first]) {
      ++at;
    }
    if (!points_[first].mover) {
      continue;
    }
    pair.memory.settling();
    double put_in = 0.0;
    for (std::size_t i = first; i < at; ++i) {
      ContactPoint& point = points_[i];
      const Mover& mover = others()[*point.mover];
      const Vector way_W = mover.X_WM * point.p_M - point.p_W;
      std::array<double, 3> ahead{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double predicted_mps =
            point.other_mps[k] - settled_s_ * point.other_1pkg[k] * point.force_n[k];
        ahead[k] = point.direction_W[k].dot(way_W) - settled_s_ * predicted_mps;
        // Its work on the other, by the velocity that it has now.
        const double now_mps = point.direction_W[k].dot(mover.velocity_W(way_W + point.p_W));
        const double more = 0.5 * settled_s_ * point.force_n[k] * (predicted_mps - now_mps);
        work_j_ += more;
        put_in -= k == 0 ? point.normal_work_j(settled_s_) + more : 0.0;
      }
      point.follow(ahead);
      pair.memory.settled(i - first, point, point.left_m(settled_s_) + ahead[0]);
    }
    pair.held_j = std::clamp(pair.held_j + put_in, 0.0, pair.memory.spring_j());
  }
}

/// Minimum height of the body's surface above the terrain.
double ContactSet::above_terrain_m(const ContactBody& body, std::size_t index,
                                   const ContactLink& link) {
  const Eigen::Isometry3d X_WS = link.X_WL * body.X_LS;
  if (rolls_on(body, X_WS)) {  // Edges are between the points of its surface.
    if (carried_ == Carried::by_model) {
      return wall_near(*ground_, body, X_WS, link.X_WL.linear().col(2)) ? 0.0 : kNoWall_m;
    }
    nearest_on_side(*ground_, body.shape, X_WS, kLow_m, places_);
    const auto nearest = std::ranges::min_element(places_, {}, &SidePlace::gap_m);
    return nearest == places_.end() ? kLow_m : nearest->gap_m;
  }
  double least = 1e300;
  for (const Vector& p_S : surface_m_[index]) {
    const Vector p = X_WS * p_S;
    least = std::min(least, p.z() - ground_->height_m(p.x(), p.y()));
  }
  const Vector lowest = X_WS * body.shape.support(-X_WS.linear().row(2).transpose());
  return std::min(least, lowest.z() - ground_->height_m(lowest.x(), lowest.y()));
}

bool ContactSet::meets(const ContactBody& body, const ContactLink& link, const Vector& normal_W,
                       std::uint8_t soil) const {
  return carried_ != Carried::by_model ||
         in_the_way(body, link.X_WL.linear(), normal_W, ground_->soil(soil).friction);
}

void ContactSet::pair_up(std::uint32_t body, std::uint32_t obstacle) {
  if (pairs_.size() == pairs_.capacity()) {
    ++dropped_;
    return;
  }
  // In the order of bodies, then obstacles, as the list of before.
  const auto before =
      std::ranges::lower_bound(others_, std::pair{body, obstacle}, {}, [](const Pair& pair) {
        return std::pair{pair.body, pair.obstacle};
      });
  if (before != others_.end() && before->body == body && before->obstacle == obstacle) {
    pairs_.push_back(*before);
  } else {
    Pair& pair = pairs_.emplace_back();
    pair.body = body;
    pair.obstacle = obstacle;
  }
}

/// Broad phase: pairs each body with the obstacles, loose bodies and terrain whose boxes along the
/// world's axes overlap its own, grown by kSlack_m, and sets the way after which this is repeated.
void ContactSet::look(std::span<const ContactLink> links) {
  std::swap(pairs_, others_);
  pairs_.clear();
  travelled_m_ = 0.0;
  look_after_m_ = kSlack_m - kReach_m;
  const std::span<const Mover> movers = others();
  const auto fixed = static_cast<std::uint32_t>(ground_->obstacles().size());
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    const ContactBody& body = bodies_[i];
    const Eigen::Isometry3d X_WS = links[body.link].X_WL * body.X_LS;
    const Vector middle = X_WS * body.shape.middle_m();
    const Vector half = half_box(body.shape, X_WS.linear()) + Vector::Constant(kSlack_m);
    const auto in_reach = [&](const Eigen::Isometry3d& X_WO, const ConvexShape& shape) {
      const Vector way = X_WO * shape.middle_m() - middle;
      const Vector room = half + half_box(shape, X_WO.linear());
      return !(way.cwiseAbs().array() > room.array()).any();
    };
    found_.clear();
    if (body.meets_obstacles) {
      ground_->obstacles_near(middle.head<2>() - half.head<2>(), middle.head<2>() + half.head<2>(),
                              found_);
    }
    std::ranges::sort(found_);
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    for (const std::uint32_t obstacle : found_) {
      const LeaningObstacle* lean = lean_of(obstacle);
      if ((lean == nullptr || !lean->down || lean->solid) &&
          in_reach(pose_of(obstacle), ground_->shape(obstacle))) {
        pair_up(i, obstacle);
      }
    }
    for (std::uint32_t j = siblings_ != nullptr ? i + 1 : 0; j < movers.size(); ++j) {
      if (body.meets_obstacles && in_reach(movers[j].X_WM, *movers[j].shape)) {
        pair_up(i, fixed + j);
      }
    }
    if (body.meets_terrain && !links[body.link].rests) {
      const double above = above_terrain_m(body, i, links[body.link]);
      if (above < kLow_m) {
        pair_up(i, kTerrain);
      } else {
        look_after_m_ = std::min(look_after_m_, 0.25 * (above - kReach_m));
      }
    }
  }
}

void ContactSet::begin(double h, std::span<const ContactLink> links) {
  if (siblings_ == nullptr) {
    follow_others();
  }
  points_.clear();
  pair_of_.clear();
  double fastest = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const ContactBody& body = bodies_[i];
    const ContactLink& link = links[body.link];
    const double arm = body.X_LS.translation().norm() + body.shape.reach_m();
    fastest = std::max(fastest, link.v_WL_W.norm() + arm * link.w_WL_W.norm());
    // A turn by the angle t takes a point at its arm 2 arm sin(t / 2) far: |R - R'| / sqrt 2.
    const Eigen::Isometry3d& before = at_[body.link].X_WL;
    moved_m_[i] = (link.X_WL.translation() - before.translation()).norm() +
                  std::numbers::sqrt2 / 2.0 * arm * (link.X_WL.linear() - before.linear()).norm();
  }
  std::copy(links.begin(), links.end(), at_.begin());
  for (const Mover& mover : others()) {
    fastest = std::max(fastest, mover.v_W.norm() + mover.shape->reach_m() * mover.w_W.norm());
  }
  if (travelled_m_ > look_after_m_ - 2.0 * h * fastest) {
    look(links);
  }
  for (Pair& pair : pairs_) {
    if (pair.obstacle == kTerrain) {
      meet_terrain(pair, h, links);
    } else {
      meet(pair, h, links);
    }
  }
}

void ContactSet::shorten(double h) {
  others_due_s_ = h;
  for (ContactPoint& point : points_) {
    point.begin(h, point.start_mps);
  }
}

bool ContactSet::rolls_over(const ContactBody& body, std::size_t obstacle,
                            const ContactLink& link) const {
  const Vector middle_W = link.X_WL * (body.X_LS * body.shape.middle_m());
  if (body.climb.radius_m > 0.0) {
    return climbs(body.climb, *ground_, obstacle, middle_W, link.X_WL.linear().col(2));
  }
  const Vector step_W = middle_W - body.step_below_m * link.X_WL.linear().col(2);
  return !(body.rolls_over_balls ? ground_->too_high(obstacle, step_W)
                                 : ground_->rises_above(obstacle, step_W));
}

void ContactSet::meet(Pair& pair, double h, std::span<const ContactLink> links) {
  const ContactBody& body = bodies_[pair.body];
  const ContactLink& link = links[body.link];
  const Mover* const mover = mover_of(pair.obstacle);
  const double arm = body.X_LS.translation().norm() + body.shape.reach_m();
  double reach = kReach_m + h * (link.v_WL_W.norm() + arm * link.w_WL_W.norm());
  pair.apart_m -= moved_m_[pair.body];
  if (mover != nullptr) {
    reach += h * (mover->v_W.norm() + mover->shape->reach_m() * mover->w_W.norm());
    pair.apart_m -= mover->way_m - pair.way_m;
    pair.way_m = mover->way_m;
  }
  pair.idle = link.rests && (mover == nullptr || mover->rests);
  if (pair.idle) {
    return;
  }
  if (pair.apart_m > reach) {
    return pair.memory.part();
  }
  const PlacedShape a{&body.shape, link.X_WL * body.X_LS};
  const PlacedShape b = mover != nullptr
                            ? PlacedShape{mover->shape, mover->X_WM}
                            : PlacedShape{&ground_->shape(pair.obstacle), pose_of(pair.obstacle)};
  Met met;
  bool meets = true;
  if (mover != nullptr) {
    met.stiffness_npm = mover->stiffness_npm;
    met.friction = mover->friction;
    met.mover = mover;
  } else {
    const Obstacle& obstacle = ground_->obstacles()[pair.obstacle];
    met.stiffness_npm = obstacle.stiffness_npm;
    met.friction = obstacle.friction;
    met.strength_nm = strength_of(pair.obstacle);
    met.foot_W = obstacle.foot_W();
    // An obstacle that has stopped a wheel still stops it, however far the tyre is compressed.
    meets = met.strength_nm > 0.0 && !(body.rolls && carried_ != Carried::by_contact &&
                                       !pair.memory.met() && rolls_over(body, pair.obstacle, link));
  }
  std::optional<Separation> found;
  if (meets) {
    const std::array<Vector, 2> kept{pair.axis_W, link.X_WL.linear() * pair.axis_L};
    // An old axis that still parts them spares the search; beyond that, only one of a contact
    // counts.
    pair.apart_m = pair.memory.met() ? -1e300 : gap_along(a, b, pair.axis_W);
    if (pair.apart_m <= reach) {
      found = separation(a, b, reach, std::span(kept).first(pair.memory.met() ? 2 : 0));
      pair.apart_m = found->gap_m;
      pair.axis_W = found->normal_W;
    }
  }
  if (pair.apart_m > reach || !found) {
    return pair.memory.part();
  }
  const Manifold touch = manifold(a, b, *found, reach);
  std::array<Touch, kManifoldPoints> touches;
  for (std::size_t i = 0; i < touch.count; ++i) {
    touches[i] = {touch.points[i].p_W, found->normal_W, touch.points[i].gap_m, 0};
  }
  pair.axis_L = link.X_WL.linear().transpose() * found->normal_W;
  add_points(pair, h, link, {touches.data(), touch.count}, met);
}

void ContactSet::meet_terrain(Pair& pair, double h, std::span<const ContactLink> links) {
  const ContactBody& body = bodies_[pair.body];
  const ContactLink& link = links[body.link];
  pair.idle = link.rests;
  if (pair.idle) {
    return;
  }
  const Eigen::Isometry3d X_WS = link.X_WL * body.X_LS;
  const double arm = body.X_LS.translation().norm() + body.shape.reach_m();
  const double reach = kReach_m + h * (link.v_WL_W.norm() + arm * link.w_WL_W.norm());
  constexpr double kDeep_m = 0.03;      // Deeper is asked from which side it came.
  constexpr double kSame_m = 1e-4;      // A point of the surface found again.
  constexpr double kSameSide_m = 0.02;  // And one of a side that rolls on.
  constexpr double kDeeper_m = 5e-4;    // By so much another is deeper before it takes its place.
  constexpr double kApart_m = 0.02;
  constexpr double kLeastDepth_m = 2e-3;  // What touches has a patch.
  Met met;
  met.stiffness_npm = kTerrain_npm;
  // All that are near, and which of them were taken in the step before.
  touches_.clear();
  const auto keep = [&](const Touch& found) {
    if (!meets(body, link, found.normal_W, found.soil)) {
      return;
    }
    const Vector p_L = link.X_WL.inverse(Eigen::Isometry) * found.p_W;
    touches_.push_back({found, pair.memory.knows(p_L, body.rolls ? kSameSide_m : kSame_m)});
  };
  const auto look_at = [&](const Vector& p) {
    auto [under, gap] = from_above(*ground_, p);
    if (gap < -kDeep_m) {
      const Vector p_L = link.X_WL.inverse(Eigen::Isometry) * p;
      std::tie(under, gap) = from_outside(
          *ground_, {X_WS * body.shape.middle_m(), link.X_WL * Vector(0.0, 0.0, p_L.z())}, p);
    }
    if (gap <= reach) {
      keep({p, under.normal_W, gap, under.soil});
    }
  };
  if (rolls_on(body, X_WS)) {
    nearest_on_side(*ground_, body.shape, X_WS, reach, places_);
    for (const SidePlace& place : places_) {
      keep({place.p_W, place.normal_W, place.gap_m, place.under.soil});
    }
  } else {
    for (const Vector& p_S : surface_m_[pair.body]) {
      look_at(X_WS * p_S);
    }
    const GroundPoint under = ground_->terrain_at(X_WS.translation().x(), X_WS.translation().y());
    const Vector down = X_WS.linear().transpose() * Vector(-under.normal_W);
    look_at(X_WS * body.shape.support(down));
    if (body.rolls) {  // The lowest of both rims: its outline has points between.
      const Feature side = body.shape.feature(down);
      for (std::size_t i = 0; i < side.count; ++i) {
        look_at(X_WS * side.points[i]);
      }
    }
  }
  if (touches_.empty()) {
    return pair.memory.part();
  }
  // The deepest; then those that press, then those that are near, by turns the one that is farthest
  // from the lines between all taken, seen along the normal of the deepest: what lies between two
  // bears nothing that they do not. Of two at one place the deeper one. One of the step before
  // stays until another is farther by two fifths.
  constexpr double kByDepth_m = 1e-3;
  std::array<Touch, kManifoldPoints> touches;
  std::size_t count = 1;
  touches[0] = std::ranges::min_element(touches_, {}, [](const NearTouch& near) {
                 return near.touch.gap_m - (near.kept ? kDeeper_m : 0.0);
               })->touch;
  const Vector& deepest_W = touches[0].normal_W;
  const auto level = [&](const Vector& p_W) {
    return Vector(p_W - p_W.dot(deepest_W) * deepest_W);
  };
  for (; count < kManifoldPoints; ++count) {
    std::pair best{-1, -1e300};
    for (const NearTouch& near : touches_) {
      double nearest = 1e300;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
          nearest = std::min(nearest, from_segment2(level(near.touch.p_W), level(touches[i].p_W),
                                                    level(touches[j].p_W)));
        }
      }
      const std::pair worth{near.touch.gap_m > 0.0 ? 0 : 1,
                            (near.kept ? 2.0 : 1.0) * nearest - kByDepth_m * near.touch.gap_m};
      if (nearest > kApart_m * kApart_m && worth > best) {
        best = worth;
        touches[count] = near.touch;
      }
    }
    if (best.first < 0) {
      break;
    }
  }
  met.friction = ground_->soil(touches[0].soil).friction;
  // A drum or wheel that rolls on hard ground would plough it: there it is the spring's alone.
  if (!body.rolls || ground_->soil(touches[0].soil).soft) {
    met.soil = &bearing_[touches[0].soil];
  }
  const auto pressing =
      std::count_if(touches.begin(), touches.begin() + static_cast<std::ptrdiff_t>(count),
                    [](const Touch& touch) { return touch.gap_m <= 0.0; });
  const double cut_m2 = body.shape.cut_m2(X_WS.linear().transpose() * touches[0].normal_W,
                                          std::max(kLeastDepth_m, -touches[0].gap_m));
  met.width_m = std::sqrt(cut_m2);
  met.patch_m2 = cut_m2 / static_cast<double>(std::max<std::ptrdiff_t>(1, pressing));
  add_points(pair, h, link, {touches.data(), count}, met);
}

void ContactSet::add_points(Pair& pair, double h, const ContactLink& link,
                            std::span<const Touch> touches, const Met& met) {
  const ContactBody& body = bodies_[pair.body];
  const bool met_before = pair.memory.met();
  pair.held_j = met_before ? pair.held_j : 0.0;
  PairMemory::Step step(pair.memory);
  const ContactLaw law =
      law_in_a_row(body, met.stiffness_npm, std::min(body.friction, met.friction), touches.size());
  const std::size_t first = points_.size();
  for (const Touch& touch : touches) {
    if (points_.size() == points_.capacity()) {
      ++dropped_;
      break;
    }
    const Vector& n = touch.normal_W;
    ContactPoint& point = points_.emplace_back();
    pair_of_.push_back(static_cast<std::uint32_t>(&pair - pairs_.data()));
    point.body = pair.body;
    point.link = body.link;
    point.obstacle = pair.obstacle;
    point.terrain = pair.obstacle == kTerrain;
    point.p_W = touch.p_W;
    point.gap_m = touch.gap_m;
    point.law = law;
    if (std::isfinite(met.strength_nm) && met.strength_nm < 1e299) {
      // The moment about the foot, shared by the points.
      const double height = std::max(kLeastHeight_m, point.p_W.z() - met.foot_W.z());
      const double level = std::max(0.1, n.head<2>().norm());
      point.law.greatest_n =
          met.strength_nm / (height * level * static_cast<double>(touches.size()));
    }
    point.direction_W[0] = n;
    const PairMemory::Place* const near =
        step.remember(link.X_WL.inverse(Eigen::Isometry) * point.p_W, point);
    PairMemory::Place& now = step.latest();
    if (near != nullptr) {
      point.dent_m = now.dent_m = near->dent_m;
    } else if (body.crush_n > 0.0) {
      // Where it is bent from before; in a contact, as far as the others' springs bear. Into
      // terrain it goes instead.
      const double fresh = met_before && !point.terrain
                               ? -point.gap_m - pair.memory.rest_m() - pair.memory.pressed_m()
                               : 0.0;
      point.dent_m = std::max(dents_.depth_m(pair.body, surface_L(point), pair.axis_L), fresh);
    }
    if (body.crush_n > 0.0) {
      const double crush = body.crush_n + body.crush_npm * point.dent_m;
      point.law.dents = crush < point.law.greatest_n;
      point.law.greatest_n = std::min(crush, point.law.greatest_n);
    }
    if (met.soil != nullptr) {
      sink(point, near, met, met_before ? pair.memory.pressed_m() : 0.0, now);
    }
    if (met.mover != nullptr) {
      point.mover = pair.obstacle - static_cast<std::uint32_t>(ground_->obstacles().size());
      point.p_M = met.mover->X_WM.inverse(Eigen::Isometry) * point.p_W;
      for (std::size_t k = 0; k < 3 && siblings_ == nullptr; ++k) {
        point.other_mps[k] = point.direction_W[k].dot(met.mover->velocity_W(point.p_W));
        point.other_1pkg[k] = static_cast<double>(touches.size()) *
                              met.mover->mobility_1pkg(point.p_W, point.direction_W[k]);
      }
      if (siblings_ == nullptr) {
        // A spring that throws it within a step is softer, of all points alike.
        const double most_npm = kResolved / (h * h * point.other_1pkg[0]);
        const double share = std::min(1.0, most_npm / law.stiffness_npm);
        point.law.stiffness_npm *= share;
        point.law.bristle_npm *= share;
        // A damper sized for the machine's mass would hold a light thing in place for a step.
        point.law.damping_nspm = std::min(
            point.law.damping_nspm,
            2.0 * kLooseDampingRatio * std::sqrt(point.law.stiffness_npm / point.other_1pkg[0]));
      }
    }
  }
  const std::span<ContactPoint> own(points_.data() + first, points_.size() - first);
  step.start(own, law.stiffness_npm);
  for (ContactPoint& point : own) {
    Vector velocity = link.velocity_W(point.p_W);
    if (met.mover != nullptr && siblings_ != nullptr) {
      velocity -= met.mover->velocity_W(point.p_W);
    }
    point.begin(h, {point.direction_W[0].dot(velocity), point.direction_W[1].dot(velocity),
                    point.direction_W[2].dot(velocity)});
  }
}

/// What the soil under a point of terrain bears, and how far it has been pressed in there.
void ContactSet::sink(ContactPoint& point, const PairMemory::Place* before, const Met& met,
                      double pressed_m, PairMemory::Place& now) const {
  constexpr double kLeastRoom_m = 0.05;
  const double depth = std::max(0.0, -point.gap_m - point.dent_m);
  now.sunk_at_W = point.p_W - point.gap_m * point.direction_W[0];
  if (before == nullptr) {
    point.sunk_m = std::max(0.0, depth - pressed_m);
  } else {
    point.sunk_m = before->sunk_m;
    // Beside the place that it has pressed in the ground is as it was.
    const double room = std::max(kLeastRoom_m, 0.5 * met.width_m);
    if ((now.sunk_at_W - before->sunk_at_W).squaredNorm() > room * room) {
      point.sunk_m = std::min(point.sunk_m, depth);
    } else {
      now.sunk_at_W = before->sunk_at_W;
    }
  }
  now.sunk_m = point.sunk_m;
  const double bears = met.patch_m2 * met.soil->pressure_pa(depth, met.width_m);
  if (bears < point.law.greatest_n) {
    point.law.greatest_n = bears;
    point.law.dents = false;
    point.law.sinks = true;
  }
}

Vector ContactSet::surface_L(const ContactPoint& point) const {
  const double overlap = -point.gap_m + point.rest_m + point.dent_m + point.sunk_m;
  return at_[point.link].X_WL.inverse(Eigen::Isometry) *
         Vector(point.p_W - 0.5 * overlap * point.direction_W[0]);
}

void ContactSet::finish(double h, double work_j) {
  settled_s_ = h;
  report_.points = 0;
  report_.force_W.setZero();
  report_.body = {};
  report_.obstacle.reset();
  report_.mover.reset();
  report_.terrain = false;
  report_.deepest_m = 0.0;
  report_.pressed_m = 0.0;
  report_.sunk_m = 0.0;
  work_j_ += work_j;
  double stored = 0.0;
  double most = 0.0;
  std::size_t seen = 0;
  for (Pair& pair : pairs_) {
    if (pair.idle) {
      stored += pair.memory.spring_j();
      continue;
    }
    const bool before = pair.pushing;
    pair.pushing = false;
    pair.memory.settling();
    // A loose body in front of a wall yields less than predicted: its springs are compressed
    // farther than the work done on them accounts for.
    const bool loose = siblings_ == nullptr && mover_of(pair.obstacle) != nullptr;
    double put_in = 0.0;
    std::size_t i = 0;
    Dent dent;
    for (; seen < points_.size() && &pairs_[pair_of_[seen]] == &pair; ++seen, ++i) {
      ContactPoint& point = points_[seen];
      const Vector force = point.sum_W();
      // The overlap that the step has ended with.
      const double depth = point.bend(-point.gap_m - h * point.end_mps[0]);
      if (point.dent_m > pair.memory.place(i).dent_m) {
        const Eigen::Matrix3d R_LW = at_[point.link].X_WL.linear().transpose();
        dent.body = pair.body;
        dent.patch_L.extend(surface_L(point));
        dent.normal_L = R_LW * point.direction_W[0];
        dent.depth_m = std::max(dent.depth_m, point.dent_m);
      }
      const double spring_j = pair.memory.settled(i, point, depth);
      put_in -= point.normal_work_j(h);
      stored += (loose ? 0.0 : spring_j) + point.bent_j();
      report_.force_W += force;
      if (point.mover && siblings_ == nullptr && !force.isZero()) {
        ground_->loose()->push(*point.mover, point.p_W, -h * force);
      }
      double& deepest = bodies_[point.body].soft ? report_.pressed_m : report_.deepest_m;
      // A tree bends as a whole: its stem's deflection is no overlap.
      const bool bends = !point.mover && !point.terrain;
      deepest = std::max(deepest, (bends ? point.law.body_share : 1.0) * depth + point.rest_m);
      if (point.force_n[0] > 0.0 || point.blocks) {
        pair.pushing = true;
        ++report_.points;
        report_.sunk_m = std::max(report_.sunk_m, point.sunk_m);
        if (force.norm() > most || report_.body.empty()) {
          most = force.norm();
          report_.body = bodies_[point.body].name;
          report_.terrain = point.terrain;
          report_.mover = point.mover;
          report_.obstacle = point.terrain || point.mover
                                 ? std::nullopt
                                 : std::optional<std::size_t>(point.obstacle);
          report_.p_W = point.p_W;
        }
      }
    }
    if (loose) {
      stored += std::clamp(pair.held_j + put_in, 0.0, pair.memory.spring_j());
    }
    report_.touches += pair.pushing && !before ? 1 : 0;
    if (dent.depth_m > 0.0 && !dents_.bend(dent)) {
      ++dropped_;
    }
  }
  report_.dent_m = dents_.deepest_m();
  report_.force_n = report_.force_W.norm();
  report_.deepest_ever_m = std::max(report_.deepest_ever_m, report_.deepest_m);
  stored_j_ = stored;
  report_.lost_j = -work_j_ - stored_j_;
  give_way(h);
  fall(h);
}

void ContactSet::give_way(double h) {
  for (const ContactPoint& point : points_) {
    if (!point.yielding || point.law.dents || point.mover || point.terrain ||
        !(point.law.greatest_n > 0.0)) {
      continue;
    }
    // What the overlap has beyond the elastic one at the limit moves the obstacle instead.
    const double excess =
        -point.gap_m - h * point.end_mps[0] - point.law.greatest_n / point.law.stiffness_npm;
    const Vector& n = point.direction_W[0];
    const double level = n.head<2>().norm();
    if (!(excess > 0.0) || level < 0.1) {
      continue;
    }
    LeaningObstacle* lean = lean_of(point.obstacle);
    if (lean == nullptr) {
      if (leaning_.size() == kMostLeaning) {
        ++dropped_;
        continue;
      }
      lean = &leaning_.emplace_back();
      lean->obstacle = point.obstacle;
    }
    const double height =
        std::max(kLeastHeight_m, point.p_W.z() - ground_->obstacles()[point.obstacle].foot_W().z());
    // About the level axis square to the push, through the foot.
    const Vector axis = Vector::UnitZ().cross(Vector(-n.x(), -n.y(), 0.0)) / level;
    const Vector turn = lean->angle_rad * lean->axis_W + excess * level / height * axis;
    lean->rate_radps = std::max(0.0, -point.end_mps[0]) * level / height;
    lean->angle_rad = turn.norm();
    lean->axis_W = lean->angle_rad > 0.0 ? Vector(turn / lean->angle_rad) : Vector::UnitX();
    moved(point.obstacle);
    if (lean->angle_rad > kDown_rad && !lean->down) {
      lean->down = true;
      ++report_.felled;
      falling_ += ground_->obstacles()[point.obstacle].tree_height_m > 0.0 ? 1 : 0;
    }
  }
}

void ContactSet::fall(double h) {
  constexpr double kMost_rad = 2.2;  // Down a steep bank.
  constexpr int kStations = 8;
  for (LeaningObstacle& lean : leaning_) {
    const Obstacle& tree = ground_->obstacles()[lean.obstacle];
    if (falling_ == 0 || !lean.down || lean.solid || !(tree.tree_height_m > 0.0)) {
      continue;
    }
    if (lean.lies) {
      lie(lean);
      continue;
    }
    // An even rod about its end: theta'' = 3 g / (2 L) sin theta.
    lean.rate_radps = std::max(0.0, lean.rate_radps) +
                      h * 1.5 * kGravity_mps2 / tree.tree_height_m * std::sin(lean.angle_rad);
    lean.angle_rad += h * lean.rate_radps;
    // The tree comes to lie when its tapering stem touches the terrain.
    const Vector foot = tree.foot_W();
    const Vector along = Eigen::AngleAxisd(lean.angle_rad, lean.axis_W) * tree.X_WO.linear().col(2);
    bool meets = lean.angle_rad >= kMost_rad;
    for (int i = 2; i <= kStations && !meets; ++i) {
      const double share = static_cast<double>(i) / kStations;
      const Vector p = foot + share * tree.tree_height_m * along;
      const double radius = tree.half_lengths_m.x() * (1.0 - share);
      meets = p.z() - radius <= ground_->height_m(p.x(), p.y());
    }
    if (meets) {
      lean.lies = true;
      lean.rate_radps = 0.0;
    }
  }
}

/// Solid from now on, if the machine is clear of it: what it would be in could only be thrown out.
void ContactSet::lie(LeaningObstacle& lean) {
  const Obstacle& tree = ground_->obstacles()[lean.obstacle];
  const Eigen::Isometry3d X_WO = lean.motion_W(tree.foot_W()) * tree.X_WO;
  const PlacedShape stem{&ground_->shape(lean.obstacle), X_WO};
  for (const ContactBody& body : bodies_) {
    const PlacedShape placed{&body.shape, at_[body.link].X_WL * body.X_LS};
    if (separation(placed, stem, kClear_m).gap_m < kClear_m) {
      return;
    }
  }
  --falling_;
  lean.solid = ground_->lay(lean.obstacle, X_WO);
  dropped_ += lean.solid ? 0 : 1;
  moved(lean.obstacle);
  look_anew();
}

void ContactSet::moved(std::size_t obstacle) {
  for (Pair& pair : pairs_) {
    if (pair.obstacle == obstacle) {
      pair.apart_m = -1e300;
    }
  }
}

void ContactSet::carry(Carried by) {
  carried_ = by;
  look_anew();
}

void ContactSet::forget() {
  pairs_.clear();
  clear_points();
  travelled_m_ = kSlack_m;
  stored_j_ = 0.0;
  work_j_ = -report_.lost_j;
}

}  // namespace rigwire::sim
