// Where the axles and wheels of one axle are and how they move against the body, for both kinds of
// axle. Closed form: two coordinates per axle, no constraint that could drift.
//
// All vectors in the axes of B, from the sprung body's centre of mass C. Coordinates s of a beam:
// heave along the arc about the push tube's pivot (up positive), roll about the tube through the
// roll centre (left side up positive is negative: right-handed about x). Of an independent axle:
// travel of the left and of the right wheel, up positive.
#pragma once

#include <Eigen/Core>
#include <array>

#include "sim/vehicle/parameters.h"

namespace rigwire::sim {

/// A mass below the springs.
struct UnsprungMass {
  double mass_kg = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  /// Inertia = transverse (1 - axis axis^T) + axial axis axis^T.
  double transverse_kgm2 = 0.0;
  double axial_kgm2 = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();
  /// Velocity of the position per rate of each coordinate.
  std::array<Eigen::Vector3d, 2> velocity_by_s;
  /// Angular velocity against the body per rate of each coordinate.
  std::array<Eigen::Vector3d, 2> rate_by_s;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< Angular velocity in W.
  /// Accelerations while the body and the coordinates have none.
  Eigen::Vector3d bias_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias_radps2 = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_BA = Eigen::Matrix3d::Identity();  ///< Axes of the axle (of the carrier).
};

/// A wheel on its carrier, the carrier's motion without the wheel's spin.
struct WheelFrame {
  Eigen::Vector3d hub_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();  ///< Unit, of spin, forward positive.
  /// Velocity of the hub per rate of each coordinate.
  std::array<Eigen::Vector3d, 2> velocity_by_s;
  /// Angular velocity of the carrier per rate of each coordinate.
  std::array<Eigen::Vector3d, 2> rate_by_s;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< Angular velocity of the carrier in W.
  Eigen::Vector3d bias_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias_radps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< Unit vector, up, of the carrier.

  /// Axes of the steered hub, not spinning.
  [[nodiscard]] Eigen::Matrix3d R_BH() const;
};

/// Generalised force on the two coordinates of one axle and its slopes.
struct SuspensionForce {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  Eigen::Vector2d stiffness = Eigen::Vector2d::Zero();  ///< -d force / d s, own coordinate.
  Eigen::Vector2d damping = Eigen::Vector2d::Zero();    ///< -d force / d s', own coordinate.
  double cross_stiffness = 0.0;  ///< -d force[0] / d s[1], symmetric: a roll bar.
};

class AxleSuspension {
 public:
  /// `front`: the push tube points to the rear.
  AxleSuspension(const VehicleAxleParameters& axle, bool front,
                 const Eigen::Vector3d& center_of_mass_m, double wheel_height_m, double spring_n);

  /// Kinematics at coordinates s, their rates and the body's rate w_B; steering angles left and
  /// right.
  void update(const Eigen::Vector2d& s, const Eigen::Vector2d& s_rate, const Eigen::Vector3d& w_B,
              const std::array<double, 2>& steer_rad);

  [[nodiscard]] SuspensionForce force(const Eigen::Vector2d& s,
                                      const Eigen::Vector2d& s_rate) const;

  [[nodiscard]] int masses() const { return beam_ ? 1 : 2; }
  [[nodiscard]] const UnsprungMass& mass(int i) const {
    return masses_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] const WheelFrame& wheel(std::size_t side) const { return wheels_[side]; }
  /// The axle's own link as a part that carries no wheel: hub_m is its origin, its axis of spin 0.
  /// With independent wheels it is the middle between them, which does not turn against the body.
  [[nodiscard]] WheelFrame carrier() const;
  /// Its axes in B.
  [[nodiscard]] Eigen::Matrix3d R_BA() const {
    return beam_ ? masses_[0].R_BA : Eigen::Matrix3d::Identity();
  }

 private:
  void update_beam(const Eigen::Vector2d& s, const Eigen::Vector2d& s_rate,
                   const Eigen::Vector3d& w_B, const std::array<double, 2>& steer_rad);
  void update_independent(const Eigen::Vector2d& s, const Eigen::Vector2d& s_rate,
                          const Eigen::Vector3d& w_B, const std::array<double, 2>& steer_rad);

  VehicleAxleParameters axle_;
  bool beam_;
  double spring_n_;
  double heave_per_rad_ = 0.0;  ///< Signed; the inverse of the tube's angle per heave. 0: guided.
  Eigen::Vector3d centre_m_;    ///< Centre of the axle at rest.
  Eigen::Vector3d pivot_m_;
  std::array<UnsprungMass, 2> masses_;
  std::array<WheelFrame, 2> wheels_;
  std::array<double, 2> steer_rad_{};  ///< Angles of the cosines and sines below.
  std::array<double, 2> steer_cosine_{1.0, 1.0};
  std::array<double, 2> steer_sine_{};
};

}  // namespace rigwire::sim
