// Corners of the body that run into the ground (obstacles meet its boxes, obstacle_contact.h): a
// spring with damping along the surface's normal and dry friction that can stand still across it.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "sim/contact/bristle.h"
#include "sim/ground/ground.h"
#include "sim/vehicle/parameters.h"
#include "sim/vehicle/velocity_system.h"

namespace rigwire::sim {

class ChassisContact {
 public:
  /// Points are kept from the sprung body's centre of mass.
  explicit ChassisContact(const WheeledVehicleParameters& parameters);

  /// Finds the points that touch, at a pose of the centre of mass, and their laws for this step.
  void begin(double h, const Ground& ground, const Eigen::Vector3d& p_WC,
             const Eigen::Matrix3d& R_WB, const Velocities& start);
  void add(double h, const Velocities& start, VelocitySystem& system) const;
  /// Compares forces with their limits at the velocities found; true when one has to be held at a
  /// limit, or no longer.
  [[nodiscard]] bool changes(const Velocities& found);
  void settle(double h, const Velocities& found);

  [[nodiscard]] bool touching() const { return active_ > 0; }

 private:
  struct Point {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    std::array<Bristle, 2> across;
    bool touching = false;
    bool released = false;
    bool sliding = false;
    double friction = 0.0;
    ImplicitForce normal;
    std::array<ImplicitForce, 2> tangent;
    std::array<double, 2> held_n{};  ///< While sliding.
    VelocityRow normal_row;
    std::array<VelocityRow, 2> tangent_row;
  };

  std::array<Point, kChassisPoints> points_;
  std::size_t count_ = 0;
  std::size_t active_ = 0;
  double stiffness_npm_;
  double damping_nspm_;
  BristleParameters bristle_;
};

}  // namespace rigwire::sim
