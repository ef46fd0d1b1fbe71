// The excavator's arm in Simbody, written against its own interface: pin joints, mass properties,
// and the drives as forces between stations on the bodies (boom, stick) or as a torque (swing,
// bucket).
//
// Independent: all dynamics and the geometry of the boom's and the stick's cylinder. Shared with
// the code under test: the length and lever of the bucket's four-bar.
//
// Simbody 3.7 does not compile as C++20, our headers do not as C++17: hence types of its own.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <utility>

namespace rigwire::oracle {

struct SimbodyLink {
  double mass_kg = 0.0;
  Eigen::Vector3d center_m;
  Eigen::Vector3d inertia_kgm2;  ///< About the centre, along the link's axes.
};

/// Upper, boom, stick, bucket; pins as (x, z) in the frames of sim/excavator/parameters.h.
struct SimbodyModel {
  std::array<SimbodyLink, 4> links;
  double gravity_mps2 = 9.81;
  double swing_axis_height_m = 0.0;
  Eigen::Vector3d boom_foot_m;
  double boom_length_m = 0.0;
  double stick_length_m = 0.0;
  Eigen::Vector2d boom_base_m, boom_rod_m;    ///< Base from the boom foot.
  Eigen::Vector2d stick_base_m, stick_rod_m;  ///< Base on the boom.
  /// Length and lever of the bucket's cylinder at a joint angle.
  std::function<std::pair<double, double>(double)> bucket_linkage;
};

struct SimbodyDrives {
  Eigen::Vector4d stiffness = Eigen::Vector4d::Zero();
  Eigen::Vector4d damping = Eigen::Vector4d::Zero();
  /// Targets and their rates at a time; empty: no drives.
  std::function<void(double, Eigen::Vector4d&, Eigen::Vector4d&)> targets;
};

class SimbodyArm {
 public:
  explicit SimbodyArm(const SimbodyModel& model);
  ~SimbodyArm();

  [[nodiscard]] Eigen::Matrix4d mass_matrix(const Eigen::Vector4d& q_rad) const;
  /// Torques that hold the arm still at q.
  [[nodiscard]] Eigen::Vector4d gravity_load(const Eigen::Vector4d& q_rad) const;
  /// Joint angles after `span_s` from rest at q by Runge-Kutta-Merson with that accuracy.
  [[nodiscard]] Eigen::Vector4d run(const Eigen::Vector4d& q_rad, double span_s, double accuracy,
                                    const SimbodyDrives& drives);

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace rigwire::oracle
