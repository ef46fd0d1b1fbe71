#include "sim/contact/pair_memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigwire::sim {
namespace {

constexpr double kFreshOverlap_m = 1e-4;  // A spring may always hold so much.
constexpr double kSamePlace_m = 0.05;     // A point found again at its place on the link.

}  // namespace

bool PairMemory::knows(const Eigen::Vector3d& p_L, double reach_m) const {
  return std::any_of(
      places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(remembered_),
      [&](const Place& place) { return (place.p_L - p_L).squaredNorm() < reach_m * reach_m; });
}

void PairMemory::part() {
  met_ = false;
  remembered_ = 0;
}

const PairMemory::Place* PairMemory::Step::remember(const Eigen::Vector3d& p_L,
                                                    ContactPoint& point) {
  const Place* near = nullptr;
  double least = kSamePlace_m * kSamePlace_m;
  for (std::size_t k = 0; k < pair_->remembered_; ++k) {
    const double distance2 = (pair_->places_[k].p_L - p_L).squaredNorm();
    if (!used_[k] && distance2 < least) {
      least = distance2;
      near = &pair_->places_[k];
    }
  }
  now_[taken_] = {};
  now_[taken_++].p_L = p_L;
  // Directions across, turned with the normal.
  const Eigen::Vector3d& n = point.direction_W[0];
  Eigen::Vector3d across =
      std::abs(n.x()) < 0.8 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  if (near != nullptr) {
    used_[static_cast<std::size_t>(near - pair_->places_.data())] = true;
    if (near->friction.first_W.cross(n).squaredNorm() > 0.25) {
      point.friction = near->friction;
      across = near->friction.first_W;
    }
  }
  const Eigen::Vector3d t1 = (across - across.dot(n) * n).normalized();
  point.friction.first_W = t1;
  point.direction_W = {n, t1, n.cross(t1)};
  return near;
}

void PairMemory::Step::start(std::span<ContactPoint> points, double stiffness_npm) {
  const bool met_before = std::exchange(pair_->met_, true);
  double overlap = 0.0;
  for (const ContactPoint& point : points) {
    overlap = std::max(overlap, -point.gap_m - point.dent_m - point.sunk_m);
  }
  if (!points.empty()) {
    pair_->rest_m_ = met_before ? std::min(pair_->rest_m_, overlap) : overlap;
  }
  double spring = 0.0;
  // Spring energy without yielding; softer springs, farther from it, may hold it.
  double unlimited = 0.0;
  for (ContactPoint& point : points) {
    point.rest_m = pair_->rest_m_;
    point.gap_m += pair_->rest_m_ + point.dent_m + point.sunk_m;
    const double pressed = std::max(0.0, -point.gap_m);
    spring += point.spring_j(pressed);
    unlimited += 0.5 * point.law.stiffness_npm * pressed * pressed;
  }
  const double allowed = pair_->spring_j_ + 0.5 * stiffness_npm * kFreshOverlap_m * kFreshOverlap_m;
  const double share = spring > allowed ? allowed / unlimited : 1.0;
  for (ContactPoint& point : points) {
    point.law.stiffness_npm *= share;
  }
  pair_->places_ = now_;
  pair_->remembered_ = taken_;
}

double PairMemory::settled(std::size_t i, const ContactPoint& point, double depth_m) {
  Place& place = places_[i];
  place.friction = point.friction;
  place.dent_m = point.dent_m;
  place.sunk_m = point.sunk_m;
  pressed_m_ = std::max(pressed_m_, depth_m);
  const double spring = point.spring_j(depth_m);
  spring_j_ += spring;
  return spring;
}

}  // namespace rigwire::sim
