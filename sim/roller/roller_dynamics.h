// Planar motion of the roller and the spins of its drums, solved together.
//
// Unknown velocities (u, v, r, w_f, w_r) at the end of the step: centre of mass forward and left in
// the frame's plane, yaw rate, drum rates. One linearly implicit Euler step solves
//
//     (M + h G) x' = M x + h (offsets + gravity + supplements)
//
// where strips, brakes, rolling resistance and the drive's pressures are on the left with their
// gains. Limits (friction circle, brake torque, relief valve) are tested after the solve; when one
// changes state, the system is solved again, until nothing changes (an active set on a convex
// problem, so that neither order nor history of the tests matters). Twelve rounds at most; see
// unsettled_steps().
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
#include "sim/roller/drum_train.h"
#include "sim/roller/parameters.h"

namespace rigwire::sim {

using RollerVelocity = Eigen::Matrix<double, 5, 1>;

/// One point of contact: speeds along its directions are rows . velocities of the solver.
template <int kUnknowns>
struct ContactRows {
  using Velocity = Eigen::Matrix<double, kUnknowns, 1>;

  ContactPoint* point = nullptr;
  std::array<Velocity, 3> rows;

  [[nodiscard]] std::array<double, 3> along(const Velocity& x) const {
    return {rows[0].dot(x), rows[1].dot(x), rows[2].dot(x)};
  }
  /// Adds to (M + h gain) x' = ... + h offset, with the limits of this pass.
  template <class Matrix>
  void add(double h, Matrix& A, Velocity& b) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const ImplicitForce law = point->acting(i);
      A += (h * law.gain) * rows[i] * rows[i].transpose();
      b += (h * law.offset) * rows[i];
    }
  }
};
using RollerContact = ContactRows<5>;

/// Loads of the roller in one step.
struct RollerLoads {
  RollerMass mass;
  Eigen::Vector2d gravity_mps2 = Eigen::Vector2d::Zero();  ///< In the frame's plane.
  Eigen::Vector3d supplement = Eigen::Vector3d::Zero();    ///< N, N, N m about the centre of mass.
  std::array<DrumSituation, 2> drum;
  DrumTorqueLimits torque;
  /// Limit of the soft soil's force on the drum's centre, along the drum's direction.
  std::array<double, 2> ploughing_limit_n{};
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
  [[nodiscard]] DrumTrain& train() { return train_; }
  [[nodiscard]] double rolling_torque_nm(std::size_t which) const {
    return train_.rolling_torque_nm(which);
  }
  /// Clears the drums' bristles and their results: they have left the ground.
  void leave_ground();
  /// Force of soft soil on the drum's centre, forward along its direction.
  [[nodiscard]] double ploughing_n(std::size_t which) const {
    return ploughing_[which].torque_nm();
  }
  /// Force of the ground on the machine in the last step, in the frame's axes.
  [[nodiscard]] Eigen::Vector2d ground_force_n() const;
  /// Number of steps whose limits still changed in the last permitted round.
  [[nodiscard]] std::uint64_t unsettled_steps() const { return unsettled_steps_; }

 private:
  RollerParameters parameters_;
  std::array<DrumContact, 2> drums_;
  DrumTrain train_;
  std::array<SpinFriction, 2> ploughing_;
  std::array<Eigen::Vector3d, 2> way_row_{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::uint64_t unsettled_steps_ = 0;
};

}  // namespace rigwire::sim
