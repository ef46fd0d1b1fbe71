// Torques between drums and machine: brakes, rolling resistance and the hydraulic drive.
//
// They are linear in the drums' rates, with limits that are tested after a velocity solve, so that
// they fit into the equations of the machine's dynamics (roller_dynamics.h, tipped_roller.h):
// begin(), then torques() and test() in each pass until nothing changes, then settle().
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "sim/contact/bristle.h"
#include "sim/driveline/hydrostatic_drive.h"
#include "sim/roller/parameters.h"

namespace rigwire::sim {

/// Dry friction on one drum's rate (brake, rolling resistance), or on its centre's way (soft soil).
class SpinFriction {
 public:
  explicit SpinFriction(const BristleParameters& parameters) : parameters_(parameters) {}

  void begin(double h, double limit_nm, double rate_before_radps);
  /// True when it changed between holding and slipping.
  [[nodiscard]] bool test(double rate_radps);
  void settle(double rate_radps);
  void preload(double torque_nm) { bristle_.yield(parameters_, torque_nm); }
  /// Clears the bristle and the torque.
  void reset();

  /// Torque on the drum = offset - gain rate.
  [[nodiscard]] ImplicitForce law() const {
    return side_ == 0 ? law_ : ImplicitForce{side_ * limit_nm_, 0.0};
  }
  /// Torque on the drum in the last step.
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

/// Returns the bristle of a holding part: damping 2 zeta sqrt(k m), no relaxation.
[[nodiscard]] BristleParameters held_bristle(double stiffness, double damping_ratio,
                                             double inertia);

/// Returns the bristles (angle) of a drum's brake and of its rolling resistance.
[[nodiscard]] std::array<BristleParameters, 2> spin_bristles(const RollerParameters& parameters);

/// Maximum torques of a step, front and rear.
struct DrumTorqueLimits {
  std::array<double, 2> brake_nm{};
  std::array<double, 2> rolling_nm{};
};

class DrumTrain {
 public:
  explicit DrumTrain(const RollerParameters& parameters);

  /// One step of h > 0. drive.begin() has been called.
  void begin(double h, const DrumTorqueLimits& limits, const HydrostaticDrive& drive,
             const Eigen::Vector2d& rate_radps);
  /// Torques on the drums = offset - gain (rates), with the limits of this pass.
  struct Torques {
    Eigen::Matrix2d gain = Eigen::Matrix2d::Zero();
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  };
  [[nodiscard]] Torques torques() const;
  /// True when a limit changed.
  [[nodiscard]] bool test(const Eigen::Vector2d& rate_radps);
  /// Ends the step; drive.finish() is called here.
  void settle(const Eigen::Vector2d& rate_radps, HydrostaticDrive& drive);

  /// The brake of a drum at rest holds this torque, as far as `limit_nm`.
  void preload(std::size_t drum, double torque_nm, double limit_nm);
  [[nodiscard]] double rolling_torque_nm(std::size_t drum) const {
    return rolling_[drum].torque_nm();
  }

 private:
  /// One loop pressure: within its limit, or at it.
  struct Pressure {
    HydrostaticCircuit circuit;
    Eigen::Vector2d displacement_m3prad = Eigen::Vector2d::Zero();
    int side = 0;
  };

  std::array<SpinFriction, 2> brakes_;
  std::array<SpinFriction, 2> rolling_;
  std::array<Pressure, 2> pressures_;
  std::size_t circuits_ = 0;
  double relief_pa_ = 0.0;
  double friction_nmsprad_ = 0.0;  ///< Viscous, of the motors.
};

}  // namespace rigwire::sim
