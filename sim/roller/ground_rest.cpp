#include "sim/roller/ground_rest.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sim/ground/obstacle_shapes.h"

namespace rigwire::sim {

GroundRest::GroundRest(const RollerParameters& parameters, const Ground& ground)
    : ground_(&ground),
      radius_m_(parameters.drum.radius_m),
      pivot_x_m_(parameters.pivot_x_m),
      width_m_(parameters.drum.width_m),
      frequency_radps_(2.0 * std::numbers::pi * parameters.rest_frequency_hz),
      damping_ratio_(parameters.rest_damping_ratio),
      drum_strips_(static_cast<std::size_t>(parameters.drum.strips)),
      count_(2 * drum_strips_) {
  near_.reserve(1024);
  place_strips({0.0, 0.0});
}

void GroundRest::climb(const Eigen::Vector3d& p_W, const Eigen::Matrix3d& R_WB, double steer_rad,
                       StripGround& strip) const {
  // Looked at from below, so that a drum that is still above the obstacle knows its height, too.
  constexpr double kBelow_m = 0.1;
  constexpr int kHalvings = 40;
  const Eigen::Vector3d up_W = R_WB.col(2);
  const Eigen::Vector3d axle_W =
      std::cos(steer_rad) * R_WB.col(1) - std::sin(steer_rad) * R_WB.col(0);
  const Eigen::Vector3d low_W = p_W + (radius_m_ - kBelow_m) * up_W;
  for (const std::uint32_t index : near_) {
    const Obstacle& obstacle = ground_->obstacles()[index];
    if (ground_->too_high(index, low_W + kBelow_m * up_W) ||
        !disc_overlap(obstacle, low_W, axle_W, radius_m_)) {
      continue;
    }
    // The least lift that frees the disc, by halving.
    double least = 0.0;
    double greatest = kBelow_m + 2.0 * radius_m_;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (least + greatest);
      const bool free = !disc_overlap(obstacle, low_W + middle * up_W, axle_W, radius_m_);
      (free ? greatest : least) = middle;
    }
    const double gap_m = greatest - kBelow_m;
    if (gap_m <= strip.gap_m) {
      continue;
    }
    const auto touch = disc_overlap(obstacle, low_W + (least - 1e-6) * up_W, axle_W, radius_m_);
    strip.gap_m = gap_m;
    strip.point.obstacle = true;
    strip.point.friction = obstacle.friction;
    if (touch) {
      const Eigen::Vector3d& n = touch->normal_W;
      const double scale = 1.0 / std::max(0.1, n.dot(up_W));
      strip.point.normal_W = n;
      strip.slope = {-scale * n.dot(R_WB.col(0)), -scale * n.dot(R_WB.col(1))};
    }
  }
}

// Places of the strips and the inverse of the normal equations: only the steering changes them.
void GroundRest::place_strips(const std::array<double, 2>& steer_rad) {
  steer_rad_ = steer_rad;
  const double share = 1.0 / static_cast<double>(drum_strips_);
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  for (std::size_t drum = 0; drum < 2; ++drum) {
    const double x = drum == 0 ? pivot_x_m_ : -pivot_x_m_;
    const double c = std::cos(steer_rad[drum]);
    const double s = std::sin(steer_rad[drum]);
    for (std::size_t i = 0; i < drum_strips_; ++i) {
      const double y = ((static_cast<double>(i) + 0.5) * share - 0.5) * width_m_;
      StripGround& strip = strips_[drum * drum_strips_ + i];
      strip.p_B_m = {x - y * s, y * c};
      // Normal equations of gap = heave + y roll - x pitch over all strips.
      const Eigen::Vector3d row(1.0, strip.p_B_m.y(), -strip.p_B_m.x());
      sums += row * row.transpose();
    }
  }
  // One strip per drum leaves roll undetermined: hold it.
  sums(1, 1) += 1e-9;
  inverse_ = sums.inverse();
}

void GroundRest::look(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB,
                      const std::array<double, 2>& steer_rad) {
  if (steer_rad != steer_rad_) {
    place_strips(steer_rad);
  }
  near_.clear();
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(pivot_x_m_ + radius_m_ + 0.5 * width_m_);
  ground_->obstacles_near(p_WB.head<2>() - reach, p_WB.head<2>() + reach, near_);
  // The terrain alone; obstacles after it.
  constexpr double ceiling_m = -std::numeric_limits<double>::infinity();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    StripGround& strip = strips_[i];
    const double x = strip.p_B_m.x();
    const double y = strip.p_B_m.y();
    const Eigen::Vector3d p_W = p_WB + x * R_WB.col(0) + y * R_WB.col(1);
    strip.point = ground_->at(p_W.x(), p_W.y(), ceiling_m);
    const Eigen::Vector3d& n = strip.point.normal_W;
    // Gap along the frame's z to the surface's tangent plane, and that plane's slopes in the frame.
    const double scale = 1.0 / std::max(0.1, n.dot(R_WB.col(2)));
    strip.gap_m = (strip.point.height_m - p_W.z()) * n.z() * scale;
    strip.slope = {-scale * n.dot(R_WB.col(0)), -scale * n.dot(R_WB.col(1))};
    climb(p_W, R_WB, steer_rad[i / drum_strips_], strip);
    right += Eigen::Vector3d(strip.gap_m, strip.gap_m * y, -strip.gap_m * x);
  }
  deviation_ = fit(right);
}

RestMotion GroundRest::fit(const Eigen::Vector3d& right) const {
  const Eigen::Vector3d found = inverse_ * right;
  return {found[0], found[1], found[2]};
}

RestMotion GroundRest::rates(double h, const Eigen::Vector3d& planar,
                             const RestMotion& before) const {
  // The ground's rate along the frame's z where a strip moves over it.
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const StripGround& strip = strips_[i];
    const double x = strip.p_B_m.x();
    const double y = strip.p_B_m.y();
    const double climbing = strip.slope.x() * (planar[0] - planar[2] * y) +
                            strip.slope.y() * (planar[1] + planar[2] * x);
    right += Eigen::Vector3d(climbing, climbing * y, -climbing * x);
  }
  const RestMotion ground = fit(right);
  // y'' = w^2 (gap) + 2 zeta w (y_g' - y') by backward Euler, the ground's own rate fed forward.
  const double stiff = h * frequency_radps_ * frequency_radps_;
  const double follow = stiff * h + 2.0 * damping_ratio_ * frequency_radps_ * h;
  const double scale = 1.0 / (1.0 + follow);
  const auto solve = [&](double rate, double away, double forward) {
    return (rate + stiff * away + follow * forward) * scale;
  };
  return {solve(before.heave, deviation_.heave, ground.heave),
          solve(before.roll, deviation_.roll, ground.roll),
          solve(before.pitch, deviation_.pitch, ground.pitch)};
}

}  // namespace rigwire::sim
