// What the roller's tests share: grounds, commands, short names for readings.
#pragma once

#include <chrono>
#include <cmath>

#include "fields/constants.h"
#include "sim/roller/tandem_roller.h"

namespace rigwire::sim::test {

using namespace std::chrono_literals;

inline constexpr double kGravity = 9.80665;

inline SoilParameters surface(double friction) {
  SoilParameters soil;
  soil.friction = friction;
  return soil;
}

/// Rises along east.
inline Ground rising(double slope_rad, double friction) {
  return Ground::plane({-std::sin(slope_rad), 0.0, std::cos(slope_rad)}, surface(friction));
}

inline Ground level(double friction = 0.8) {
  return Ground::plane(Eigen::Vector3d::UnitZ(), surface(friction));
}

/// Neither water nor chips, drums with the ground's whole friction, no rolling resistance, and
/// nothing but the pump that follows a travel speed.
inline RollerParameters bare() {
  RollerParameters p;
  p.sprinkler.initial_kg = 0.0;
  p.spreader.initial_kg = 0.0;
  p.drum.friction_factor = 1.0;
  p.drum.rolling_resistance = 0.0;
  p.travel_control = false;
  return p;
}

inline VehicleCommand travel(double speed_mps, double front_rad = 0.0, double rear_rad = 0.0) {
  VehicleCommand command;
  command.parking_brake = false;
  command.travel_speed_mps = speed_mps;
  command.front_steer_rad = front_rad;
  command.rear_steer_rad = rear_rad;
  return command;
}

inline const LinkMotion& frame(const TandemRoller& machine) {
  return machine.links()[0];
}

inline Eigen::Vector3d position(const TandemRoller& machine) {
  return frame(machine).X_WL.translation();
}

inline double yaw_rad(const TandemRoller& machine) {
  const Eigen::Matrix3d R = frame(machine).X_WL.linear();
  return std::atan2(R(1, 0), R(0, 0));
}

/// Velocity of the frame's origin in its own axes.
inline Eigen::Vector3d own_velocity(const TandemRoller& machine) {
  return frame(machine).X_WL.linear().transpose() * frame(machine).v_WL_W;
}

/// What an accelerometer at the frame's origin feels, in its axes.
inline Eigen::Vector3d specific_force(const LinkMotion& link) {
  return link.X_WL.linear().transpose() * (link.a_WL_W + Eigen::Vector3d(0.0, 0.0, kGravity));
}

}  // namespace rigwire::sim::test
