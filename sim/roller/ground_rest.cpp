#include "sim/roller/ground_rest.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigwire::sim {

GroundRest::GroundRest(const RollerParameters& parameters, const Ground& ground)
    : ground_(&ground),
      radius_m_(parameters.drum.radius_m),
      pivot_x_m_(parameters.pivot_x_m),
      width_m_(parameters.drum.width_m),
      frequency_radps_(2.0 * std::numbers::pi * parameters.rest_frequency_hz),
      damping_ratio_(parameters.rest_damping_ratio),
      drum_strips_(static_cast<std::size_t>(parameters.drum.strips)),
      count_(2 * drum_strips_) {}

void GroundRest::look(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB,
                      const std::array<double, 2>& steer_rad) {
  const double share = 1.0 / static_cast<double>(drum_strips_);
  const double ceiling_m = p_WB.z() + radius_m_;
  const Eigen::Vector3d z_W = R_WB.col(2);
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  for (std::size_t drum = 0; drum < 2; ++drum) {
    const double x = drum == 0 ? pivot_x_m_ : -pivot_x_m_;
    const double c = std::cos(steer_rad[drum]);
    const double s = std::sin(steer_rad[drum]);
    for (std::size_t i = 0; i < drum_strips_; ++i) {
      StripGround& strip = strips_[drum * drum_strips_ + i];
      const double y = ((static_cast<double>(i) + 0.5) * share - 0.5) * width_m_;
      strip.p_B_m = {x - y * s, y * c};
      const Eigen::Vector3d p_W = p_WB + R_WB.leftCols<2>() * strip.p_B_m;
      strip.point = ground_->at(p_W.x(), p_W.y(), ceiling_m);
      const Eigen::Vector3d& n = strip.point.normal_W;
      strip.gap_m = (strip.point.height_m - p_W.z()) * n.z() / std::max(0.1, n.dot(z_W));
      const Eigen::Vector3d row(1.0, strip.p_B_m.y(), -strip.p_B_m.x());
      sums.noalias() += row * row.transpose();
    }
  }
  // One strip per drum leaves roll undetermined: hold it.
  sums(1, 1) += 1e-9;
  inverse_ = sums.inverse();
}

RestMotion GroundRest::fit(const std::array<double, kRollerStripsMax>& heights) const {
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const Eigen::Vector2d& p = strips_[i].p_B_m;
    right += heights[i] * Eigen::Vector3d(1.0, p.y(), -p.x());
  }
  const Eigen::Vector3d found = inverse_ * right;
  return {found[0], found[1], found[2]};
}

RestMotion GroundRest::deviation() const {
  std::array<double, kRollerStripsMax> gaps{};
  for (std::size_t i = 0; i < count_; ++i) {
    gaps[i] = strips_[i].gap_m;
  }
  return fit(gaps);
}

RestMotion GroundRest::rates(double h, const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& planar,
                             const RestMotion& before) const {
  // The ground's rate along the frame's z where a strip moves over it.
  std::array<double, kRollerStripsMax> climbing{};
  const Eigen::Vector3d z_W = R_WB.col(2);
  for (std::size_t i = 0; i < count_; ++i) {
    const StripGround& strip = strips_[i];
    const Eigen::Vector2d along(planar[0] - planar[2] * strip.p_B_m.y(),
                                planar[1] + planar[2] * strip.p_B_m.x());
    const Eigen::Vector3d v_W = R_WB.leftCols<2>() * along;
    const Eigen::Vector3d& n = strip.point.normal_W;
    climbing[i] = -n.dot(v_W) / std::max(0.1, n.dot(z_W));
  }
  const RestMotion ground = fit(climbing);
  const RestMotion gap = deviation();
  const double stiff = h * frequency_radps_ * frequency_radps_;
  const double follow = stiff * h + 2.0 * damping_ratio_ * frequency_radps_ * h;
  const auto solve = [&](double rate, double away, double forward) {
    return (rate + stiff * away + follow * forward) / (1.0 + follow);
  };
  return {solve(before.heave, gap.heave, ground.heave), solve(before.roll, gap.roll, ground.roll),
          solve(before.pitch, gap.pitch, ground.pitch)};
}

}  // namespace rigwire::sim
