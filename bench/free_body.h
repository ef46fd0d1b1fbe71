// A single rigid body that flies, falls and hits obstacles: the smallest machine there is, for
// figures and tests of the contact alone. Its step is the machines' own: linearly implicit, clamp
// last.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <utility>
#include <vector>

#include "sim/contact/contact_set.h"

namespace rigwire::sim {

class FreeBody {
 public:
  using Vector = Eigen::Vector3d;

  FreeBody(const Ground& ground, ConvexShape shape, double mass_kg, const Vector& inertia_kgm2,
           double stiffness_npm, double damping_nspm, double crush_n = 0.0, double crush_npm = 0.0,
           bool soft = false)
      : mass_kg_(mass_kg),
        inertia_(inertia_kgm2),
        contact_({{"body", 0, Eigen::Isometry3d::Identity(), std::move(shape), stiffness_npm,
                   damping_nspm, crush_n, crush_npm, false, soft}},
                 1, ground) {}

  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  Vector v_W = Vector::Zero();
  Vector w_W = Vector::Zero();
  Vector push_W = Vector::Zero();  ///< At the middle, N.
  double gravity_mps2 = 9.80665;

  void step(double h) {
    const Eigen::Matrix3d R = X_WB.linear();
    const Eigen::Matrix3d I = R * inertia_.asDiagonal() * R.transpose();
    using Six = Eigen::Matrix<double, 6, 1>;
    Six start;
    start << v_W, w_W;
    Eigen::Matrix<double, 6, 6> M = Eigen::Matrix<double, 6, 6>::Zero();
    M.topLeftCorner<3, 3>() = mass_kg_ * Eigen::Matrix3d::Identity();
    M.bottomRightCorner<3, 3>() = I;
    Six free;
    free << h * (push_W - mass_kg_ * gravity_mps2 * Vector::UnitZ()), -h * w_W.cross(I * w_W);
    const double fastest = v_W.norm() + w_W.norm() * contact_.bodies()[0].shape.reach_m();
    const bool near = contact_.near(h, fastest);
    if (near) {
      const ContactLink link{X_WB, v_W, w_W};
      contact_.begin(h, {&link, 1});
    }
    const auto row = [&](const ContactPoint& point, std::size_t i) {
      Six J;
      J << point.direction_W[i], Vector(point.p_W - X_WB.translation()).cross(point.direction_W[i]);
      return J;
    };
    const auto along = [&](const ContactPoint& point, const Six& u) {
      return std::array<double, 3>{row(point, 0).dot(u), row(point, 1).dot(u),
                                   row(point, 2).dot(u)};
    };
    Six found = start;
    for (int pass = 0; pass < 40; ++pass) {
      Eigen::Matrix<double, 6, 6> A = M;
      Six b = free;
      for (const ContactPoint& point : near ? contact_.points() : std::span<ContactPoint>{}) {
        for (std::size_t i = 0; i < 3; ++i) {
          const ImplicitForce law = point.acting(i);
          const Six J = row(point, i);
          A += h * law.gain * J * J.transpose();
          b += h * law.at(J.dot(start)) * J;
        }
      }
      found = start + A.ldlt().solve(b);
      bool changed = false;
      for (ContactPoint& point : near ? contact_.points() : std::span<ContactPoint>{}) {
        changed = point.changes(along(point, found)) || changed;
      }
      if (!changed) {
        break;
      }
    }
    if (near) {
      contact_.settle(h, [&](const ContactPoint& point) { return along(point, found); });
    }
    v_W = found.head<3>();
    w_W = found.tail<3>();
    X_WB.translation() += h * v_W;
    const double angle = h * w_W.norm();
    if (angle > 0.0) {
      X_WB.linear() =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, w_W.normalized()) * Eigen::Quaterniond(R))
              .normalized()
              .toRotationMatrix();
    }
  }

  [[nodiscard]] double energy_j() const {
    const Eigen::Matrix3d R = X_WB.linear();
    const Vector w_B = R.transpose() * w_W;
    return 0.5 * mass_kg_ * v_W.squaredNorm() + 0.5 * w_B.dot(inertia_.cwiseProduct(w_B)) +
           mass_kg_ * gravity_mps2 * X_WB.translation().z();
  }
  [[nodiscard]] const ContactSet& contact() const { return contact_; }
  /// Whatever the contact remembers of who is far away is forgotten.
  void look_anew(std::size_t obstacles) {
    for (std::size_t i = 0; i < obstacles; ++i) {
      contact_.moved(i);
    }
  }

 private:
  double mass_kg_;
  Vector inertia_;
  ContactSet contact_;
};

/// Level ground far below, with these obstacles.
inline Ground ground_with(std::vector<Obstacle> obstacles) {
  HeightField field;
  field.origin_m = {-50.0, -50.0};
  field.cell_m = 50.0;
  field.columns = field.rows = 3;
  field.heights_m.assign(9, 0.0);
  return Ground(field, {}, std::move(obstacles));
}

inline Obstacle box_obstacle(const Eigen::Vector3d& middle, const Eigen::Vector3d& half,
                             double friction = 0.6) {
  Obstacle box;
  box.X_WO.translation() = middle;
  box.half_lengths_m = half;
  box.friction = friction;
  return box;
}

inline Obstacle trunk_at(double x_m, double y_m, double radius_m, double height_m) {
  Obstacle trunk;
  trunk.shape = ObstacleShape::cylinder;
  trunk.X_WO.translation() << x_m, y_m, 0.5 * height_m;
  trunk.half_lengths_m = {radius_m, radius_m, 0.5 * height_m};
  return trunk;
}

inline Obstacle rock_at(const Eigen::Vector3d& middle, double radius_m) {
  Obstacle rock;
  rock.shape = ObstacleShape::sphere;
  rock.X_WO.translation() = middle;
  rock.half_lengths_m.setConstant(radius_m);
  return rock;
}

}  // namespace rigwire::sim
