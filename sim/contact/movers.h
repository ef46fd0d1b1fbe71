// Loose solid things that move by themselves, as seen by machines that touch them: rocks and
// crates.
//
// A machine's contact with one is solved in the machine's own step, with the other's mass condensed
// into the law of each point. With u the velocity of the machine's surface, w the mobility of the
// other (J A J^T; A is M^-1 where it is free, and (M + h sum of J_c^T gain J_c)^-1 where other
// points c hold it: a stone on the ground, a crate before a wall), u_B its own velocity before the
// push:
//
//     F = offset - gain (u - u_B + h w F)   =>
//     F = (offset + gain u_B - gain u) / (1 + h gain w)
//
// so that both feel the same force and no stiffness asks for a smaller step. Afterwards the other
// is given the opposite impulse. Exact for one point; n points of a pair count w n times, which is
// exact where they share alike and errs towards a softer push elsewhere.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <string_view>

#include "sim/contact/convex_shape.h"

namespace rigwire::sim {

struct Mover {
  const ConvexShape* shape = nullptr;  ///< About the centre of mass.
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
  double inverse_mass_1pkg = 0.0;
  Eigen::Matrix3d inverse_inertia_W = Eigen::Matrix3d::Zero();
  /// Velocity and rate (W) by an impulse at the centre of mass and a turning one (W), over a step.
  Eigen::Matrix<double, 6, 6> mobility = Eigen::Matrix<double, 6, 6>::Zero();
  double friction = 0.6;
  /// Its own stiffness, in series with the stiffness of what hits it; 0: rigid.
  double stiffness_npm = 0.0;
  bool rests = false;  ///< Does not move until it is pushed.
  double way_m = 0.0;  ///< Upper bound of the way of each of its points since the start.

  [[nodiscard]] Eigen::Vector3d velocity_W(const Eigen::Vector3d& p_W) const {
    return v_W + w_W.cross(p_W - X_WM.translation());
  }
  /// Velocity at p_W along the unit direction per impulse along it there, 1/kg.
  [[nodiscard]] double mobility_1pkg(const Eigen::Vector3d& p_W,
                                     const Eigen::Vector3d& direction_W) const {
    Eigen::Matrix<double, 6, 1> row;
    row << direction_W, (p_W - X_WM.translation()).cross(direction_W);
    return row.dot(mobility * row);
  }
};

class Movers {
 public:
  virtual ~Movers() = default;
  [[nodiscard]] virtual std::span<const Mover> movers() const = 0;
  [[nodiscard]] virtual std::string_view name(std::size_t mover) const = 0;
  /// An impulse that one is given at p_W, N s; it acts in the next advance().
  virtual void push(std::size_t mover, const Eigen::Vector3d& p_W,
                    const Eigen::Vector3d& impulse_W) = 0;
  /// Advances all by h seconds, with the impulses of the machine's step of that length; they lag
  /// the machine by one inner step. Returns the maximum speed of any of their points, m/s.
  virtual double advance(double h) = 0;
};

}  // namespace rigwire::sim
