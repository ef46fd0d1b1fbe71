// Planar motion of the roller and the spins of its drums, solved together.
//
// Unknown velocities (u, v, r, w_f, w_r) at the end of the step: centre of mass forward and left in
// the frame's plane, yaw rate, drum rates. One linearly implicit Euler step solves
//
//     (M + h G) x' = M x + h (offsets + gravity + supplements)
//
// where strips, brakes, rolling resistance and the drive's pressures stand on the left with their
// gains. Limits (friction circle, brake torque, relief valve) are tested after the solve; what
// changes state is solved again until nothing does (an active set on a convex problem, so that
// neither order nor history of the tests matters). Twelve rounds at most; see unsettled_steps().
//
// The basis in which u and v are written is that at the start of the step: there is no centrifugal
// term, momentum is kept by construction.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "sim/contact/contact_point.h"
#include "sim/driveline/hydrostatic_drive.h"
#include "sim/roller/drum_contact.h"
#include "sim/roller/parameters.h"

namespace rigwire::sim {

/// Bristles (angle) of a drum's brake and of its rolling resistance.
[[nodiscard]] std::array<BristleParameters, 2> spin_bristles(const RollerParameters& parameters);

using RollerVelocity = Eigen::Matrix<double, 5, 1>;

/// Dry friction on one drum's rate (brake, rolling resistance), or on its centre's way (soft soil).
class SpinFriction {
 public:
  explicit SpinFriction(const BristleParameters& parameters) : parameters_(parameters) {}

  void begin(double h, double limit_nm, double rate_before_radps);
  /// True when it changed between holding and slipping.
  [[nodiscard]] bool test(double rate_radps);
  void settle(double rate_radps);
  void preload(double torque_nm) { bristle_.yield(parameters_, torque_nm); }

  /// Torque on the drum = offset - gain rate.
  [[nodiscard]] ImplicitForce law() const {
    return side_ == 0 ? law_ : ImplicitForce{side_ * limit_nm_, 0.0};
  }
  /// Of the last step, on the drum.
  [[nodiscard]] double torque_nm() const { return torque_nm_; }

 private:
  BristleParameters parameters_;
  Bristle bristle_;
  double h_ = 0.0;
  double limit_nm_ = 0.0;
  int side_ = 0;  ///< 0 holding; -1 or 1: at the limit of that sign.
  ImplicitForce law_;
  double torque_nm_ = 0.0;
};

/// One point of contact with an obstacle: speeds along its directions are rows . velocity.
struct RollerContact {
  ContactPoint* point = nullptr;
  std::array<RollerVelocity, 3> rows;

  [[nodiscard]] std::array<double, 3> along(const RollerVelocity& x) const {
    return {rows[0].dot(x), rows[1].dot(x), rows[2].dot(x)};
  }
};

/// What acts on the roller in one step.
struct RollerLoads {
  RollerMass mass;
  Eigen::Vector2d gravity_mps2 = Eigen::Vector2d::Zero();  ///< In the frame's plane.
  Eigen::Vector3d supplement = Eigen::Vector3d::Zero();    ///< N, N, N m about the centre of mass.
  std::array<DrumSituation, 2> drum;
  std::array<double, 2> brake_limit_nm{};
  std::array<double, 2> rolling_limit_nm{};
  std::array<double, 2> ploughing_limit_n{};  ///< Of soft soil on the drum's centre, along it.
  std::span<const RollerContact> contacts;
};

class RollerDynamics {
 public:
  explicit RollerDynamics(const RollerParameters& parameters);

  /// One step of h > 0. drive.begin() has been called; drive.finish() is called here.
  void step(double h, const RollerLoads& loads, HydrostaticDrive& drive, RollerVelocity& velocity);
  /// Holds the machine against gravity in the frame's plane by brakes and strips, as far as they
  /// can, so that it starts without a lurch.
  void preload(const RollerLoads& loads, const std::array<double, 2>& normal_n);

  [[nodiscard]] const DrumContact& drum(std::size_t which) const { return drums_[which]; }
  [[nodiscard]] double rolling_torque_nm(std::size_t which) const {
    return rolling_[which].torque_nm();
  }
  /// Of soft soil on the drum's centre, forward along it.
  [[nodiscard]] double ploughing_n(std::size_t which) const {
    return ploughing_[which].torque_nm();
  }
  /// Of the ground on the machine in the frame's axes, last step.
  [[nodiscard]] Eigen::Vector2d ground_force_n() const;
  /// Steps whose limits still changed in the last round allowed.
  [[nodiscard]] std::uint64_t unsettled_steps() const { return unsettled_steps_; }

 private:
  RollerParameters parameters_;
  std::array<DrumContact, 2> drums_;
  std::array<SpinFriction, 2> brakes_;
  std::array<SpinFriction, 2> rolling_;
  std::array<SpinFriction, 2> ploughing_;
  std::array<Eigen::Vector3d, 2> way_row_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::uint64_t unsettled_steps_ = 0;
};

}  // namespace rigwire::sim
