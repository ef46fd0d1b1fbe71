// The roller when it is no longer supported by both drums: one rigid body with two drums that turn
// in it, free in all six directions, carried by nothing but its contacts (sim/contact): it tips
// about the rims that still touch, falls, slides and comes to rest.
//
// Unknown velocities at the end of the step, in the world's axes: centre of mass, body, and each
// drum about its axle (absolute, not relative to the yoke). One linearly implicit Euler step
//
//     (M + h G) x' = M x + h (offsets + weight - w x H)
//
// with contacts, brakes, rolling resistance and hydraulics on the left, limits tested after the
// solve as on wheels (roller_dynamics.h). A torque that turns a drum turns the body the other way;
// the drums' angular momentum turns with the body.
//
// Energy: weight is taken at the step's start and moved with the velocity of its end, which loses h
// g v m / 2 in free fall; contacts lose energy (contact_point.h). Only the drive adds energy.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "sim/roller/drum_train.h"
#include "sim/roller/roller_dynamics.h"

namespace rigwire::sim {

using TippedVelocity = Eigen::Matrix<double, 8, 1>;
using TippedContact = ContactRows<8>;

/// What acts on it in one step, and how it lies.
struct TippedLoads {
  RollerMass mass;
  Eigen::Matrix3d R_WB = Eigen::Matrix3d::Identity();
  std::array<Eigen::Vector3d, 2> axle_W{};  ///< Unit, left.
  DrumTorqueLimits torque;
  std::span<const TippedContact> contacts;
};

class TippedRoller {
 public:
  explicit TippedRoller(const RollerParameters& parameters);

  /// One step of h > 0. drive.begin() has been called; drive.finish() is called here.
  void step(double h, const TippedLoads& loads, DrumTrain& train, HydrostaticDrive& drive,
            TippedVelocity& velocity);

  /// Row of a point's speed along d, at p from the centre of mass; of a drum's with its axle's
  /// index and `arm` from there.
  [[nodiscard]] static TippedVelocity body_row(const Eigen::Vector3d& d, const Eigen::Vector3d& p);
  [[nodiscard]] static TippedVelocity drum_row(const Eigen::Vector3d& d, const Eigen::Vector3d& p,
                                               const Eigen::Vector3d& axle_W,
                                               const Eigen::Vector3d& arm, std::size_t drum);

 private:
  double spin_inertia_kgm2_;
  double gravity_mps2_;
};

}  // namespace rigwire::sim
